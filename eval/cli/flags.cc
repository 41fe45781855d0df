#include "eval/cli/flags.h"

#include <string>

#include "core/error_convention.h"

namespace {

const std::string kErrorText =  // NOLINT(cert-err58-cpp): of a flag, made before main like the flag
    alidade::ErrorConventionNames(" | ") + ": error convention of the Jacobians";

}  // namespace

DEFINE_bool(anchor_at_first, false,
            "place the first estimate at the truth in yaw and position: for an estimate with an arbitrary "
            "yaw and origin");
DEFINE_string(align, "posyaw",
              "none | pos | posyaw | se3 | sim3: alignment of the trajectory before the ATE");
DEFINE_double(align_share, 1,
              "share of the pairs, from the first on, to which the alignment is fitted, 0 to 1");
DEFINE_string(association, "alidade",
              "alidade | evo | rpg: whose rule pairs the rows of truth and estimate (docs/evaluation.md)");
DEFINE_bool(audit, false, "write observability.csv: the observability audit of the filter");
DEFINE_string(backend, "", "filter | smoother | batch: overrides the key `backend` of the configuration");
DEFINE_string(calibration, "", "calibration files of Kalibr, OpenVINS or VINS, separated by commas");
DEFINE_string(camera, "cam0", "camera to import if a calibration file holds several");
DEFINE_string(catalogue, "", "catalogue of data sets, instead of the shipped one");
DEFINE_double(cell_memory_limit_mib, 0,
              "memory limit of a cell, including its input and what it starts; a cell that exceeds it is "
              "killed and counts as failed [MiB]; 0: no limit");
DEFINE_double(cell_time_limit_s, 0,
              "wall-time limit of a cell, including loading its input; a cell that exceeds it is killed and "
              "counts as failed [s]; 0: no limit");
DEFINE_bool(check, false, "report the faults of a configuration file");
DEFINE_string(clk, "", "precise clocks, RINEX CLK, separated by commas");
DEFINE_string(compression, "none", "none | bz2 | lz4: compression of the chunks of a bag");
DEFINE_string(config, "", "configuration: a YAML file, or the name of a shipped one");
DEFINE_string(data, "", "folder that replaces ${data} in a plan, or that data fetch wrote to");
DEFINE_string(dataset, "", "folder of a sequence in the extended ASL layout, or a ROS 1 bag");
DEFINE_bool(diff, false, "print the keys in which two configuration files differ");
DEFINE_string(
    engine, "local",
    "local | slurm: what runs the cells: processes of this machine, or jobs of Slurm (docs/plans.md)");
DEFINE_string(error, "right_invariant", kErrorText.c_str());
DEFINE_string(estimate, "", "trajectory file to evaluate");
DEFINE_string(estimator, "",
              "configuration of the filter to analyse: a YAML file, or the name of a shipped one");
DEFINE_bool(follow_links, false,
            "read images that are links to files outside of the sequence's folder (git-annex, DVC, ln -s)");
DEFINE_bool(
    imu_scale, false,
    "estimate a scale factor for each axis of the IMU, and multiply the samples that are written by it");
DEFINE_string(input, "", "output folder of compare");
DEFINE_string(export, "", "folder for both trajectories in the formats of evo and rpg_trajectory_evaluation");
DEFINE_string(figures, "", "svg | pdf | svg,pdf: write figures for papers into figures/");
DEFINE_bool(interpolate, false,
            "interpolate the truth at the stamps of the estimate instead of pairing rows");
DEFINE_int32(jobs, 1,
             "number of parallel jobs: runs, rendered images or likelihoods; times of parallel runs are not "
             "comparable");
DEFINE_bool(json, false, "print the result as JSON");
DEFINE_string(kind, "estimator", "estimator | simulator | plan: kind of the configuration file");
DEFINE_double(limit, 5, "duration of the data available to a start [s]");
DEFINE_double(max_dt, 0.01, "largest stamp difference of a pair [s]; 0.02 with --association=rpg");
DEFINE_bool(list, false, "print the names of the shipped configurations of this kind");
DEFINE_string(mirror, "", "URL that replaces the first part of the URLs of a data set (`base`)");
DEFINE_string(model, "",
              "pose_only | inverse_depth | imu_propagation | preintegration | pseudorange | doppler: the "
              "measurement model");
DEFINE_bool(
    motion, false,
    "identify from the innovations of a filter on a recording in motion, instead of from one at rest");
DEFINE_string(nav, "", "broadcast orbits, RINEX, separated by commas");
DEFINE_string(obs, "", "observations, RINEX");
DEFINE_string(output, "", "output folder or file");
DEFINE_int32(overlay, 0,
             "write every N-th image with its tracks drawn on it, as overlay/<stamp>.png; 0: none");
DEFINE_bool(overwrite, false, "overwrite an existing output");
DEFINE_string(part, "0/1", "of --stage=tracks and cells: part K of N, as K/N with K from 0");
DEFINE_string(plan, "", "comparison plan: a YAML file, or the name of a shipped one");
DEFINE_bool(quiet, false, "print only errors and results");
DEFINE_bool(render, false, "render images instead of simulating tracks (render.enabled)");
DEFINE_bool(resume, false, "keep the completed cells of an interrupted comparison");
DEFINE_string(rpe, "8,16,24,32,40",
              "distances of the relative pose error [m], separated by commas; with --rpe_by another tool's "
              "deltas, by default those of the tool");
DEFINE_bool(rpe_all_pairs, false, "of --rpe_by=evo: overlapping pairs instead of consecutive ones");
DEFINE_string(rpe_by, "alidade", "alidade | evo | rpg: whose definition of the relative pose error");
DEFINE_bool(rpe_pairs_from_truth, false,
            "of --rpe_by=evo: measure the deltas along the truth instead of along the estimate");
DEFINE_double(rpe_tolerance, 0.1, "with --rpe_all_pairs: relative tolerance of the delta");
DEFINE_string(rpe_unit, "frames", "frames | m | deg | rad: unit of the deltas of --rpe_by=evo");
DEFINE_bool(score, false,
            "score the tracks: life, loss, coverage, CPU time, consistency with the truth, and errors of "
            "corners in rendered images; writes score.json and score.csv");
DEFINE_uint32(seed, 1, "seed of the simulation, and of the start drawn by init.method truth");
DEFINE_string(set, "",
              "a.b=value,...: override keys of the configuration file; may be repeated for other keys");
DEFINE_bool(show, false, "print the resolved configuration with the reason of every key");
DEFINE_string(slurm_options, "", "arguments of sbatch, such as \"--partition=long --time=60\"");
DEFINE_string(sp3, "", "precise orbits, SP3, separated by commas");
DEFINE_string(stage, "all",
              "all | worker | tracks | cells | tables: one stage of a comparison, as the processes of an "
              "engine run it");
DEFINE_int32(starts, 100, "total number of starts, distributed over the sequences of the plan");
DEFINE_string(status, "", "output folder of a comparison: print its progress");
DEFINE_double(time_offset, 0, "added to the stamps of the estimate before rows are paired [s]");
DEFINE_string(topics, "",
              "imu=/topic,cam0=/topic,...: topics of a bag whose names are not the usual ones, and what its "
              "messages lack (docs/bags.md)");
DEFINE_string(tracks, "", "tracks.csv to score with --score, instead of tracks of the front end");
DEFINE_string(truth, "", "ground-truth trajectory file");
DEFINE_double(truth_rate, 0,
              "largest rate of the poses of the truth that are used [Hz]; 0: all. Their errors should be "
              "independent of each other");
DEFINE_double(
    truth_std_deg, 0,
    "standard deviation of the orientation of the poses of the truth, one axis [deg]; 0: estimate it");
DEFINE_double(truth_std_m, 0,
              "standard deviation of the position of the poses of the truth, one axis [m]; 0: estimate it");
DEFINE_string(windows, "5,10,15,20,25", "window sizes (number of clones), separated by commas");
