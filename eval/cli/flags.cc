#include "eval/cli/flags.h"

DEFINE_bool(
    anchor_at_first, false,
    "put the first estimate where the truth is, in yaw and position: for an estimate in a world of its own");
DEFINE_string(align, "posyaw", "none | pos | posyaw | se3 | sim3: what is taken out before the ATE");
DEFINE_double(align_share, 1, "the alignment is fitted to this first share of the pairs, 0 to 1");
DEFINE_bool(audit, false, "write observability.csv: what the filter claims to observe");
DEFINE_string(backend, "", "filter | smoother | batch: replaces the key `backend` of the configuration");
DEFINE_string(calibration, "", "files of Kalibr, OpenVINS or VINS, separated by commas");
DEFINE_string(camera, "cam0", "which camera of a calibration with several");
DEFINE_bool(check, false, "name the faults of a configuration file");
DEFINE_string(clk, "", "precise clocks, RINEX CLK, separated by commas");
DEFINE_string(compression, "none", "none | bz2 | lz4: how the chunks of a bag are packed");
DEFINE_string(config, "", "configuration: a YAML file, or the name of a shipped one");
DEFINE_string(data, "", "folder that ${data} stands for in a plan");
DEFINE_string(dataset, "", "folder of a sequence in the extended ASL layout, or a ROS 1 bag");
DEFINE_bool(diff, false, "print the keys in which two configuration files differ");
DEFINE_string(error, "right_invariant", "right_invariant | left_invariant | so3xrn: the error of Jacobians");
DEFINE_string(estimate, "", "trajectory file to be scored");
DEFINE_string(estimator, "",
              "configuration of the filter that is analysed: a YAML file, or the name of a shipped one");
DEFINE_string(input, "", "cases, JSON; - reads standard input");
DEFINE_string(export, "",
              "folder that gets both trajectories as evo and rpg_trajectory_evaluation read them");
DEFINE_string(figures, "", "svg | pdf | svg,pdf: write figures for papers into figures/");
DEFINE_bool(interpolate, false, "interpolate truth at the stamps of the estimate instead of pairing rows");
DEFINE_int32(
    jobs, 1,
    "runs at a time; more than one shares the caches, so times are no longer comparable. Images drawn at "
    "a time");
DEFINE_bool(json, false, "answer in JSON");
DEFINE_string(kind, "estimator", "estimator | simulator | plan: what the configuration file is");
DEFINE_double(limit, 5, "data a start may use [s]");
DEFINE_double(max_dt, 0.01, "largest stamp difference of a pair [s]");
DEFINE_bool(list, false, "print the names of the shipped configurations of this kind");
DEFINE_string(model, "",
              "pose_only | inverse_depth | imu_propagation | preintegration | pseudorange | doppler: the "
              "measurement model");
DEFINE_string(nav, "", "broadcast orbits, RINEX, separated by commas");
DEFINE_string(obs, "", "observations, RINEX");
DEFINE_string(output, "", "where the results go");
DEFINE_int32(overlay, 0, "draw the tracks upon every so many images, as overlay/<stamp>.png; 0: none");
DEFINE_bool(overwrite, false, "write into an output that exists");
DEFINE_string(plan, "", "comparison plan: a YAML file, or the name of a shipped one");
DEFINE_bool(quiet, false, "print errors and results alone");
DEFINE_bool(render, false, "draw what the camera sees instead of simulating tracks (render.enabled)");
DEFINE_bool(resume, false, "keep the complete cells of an interrupted comparison");
DEFINE_string(rpe, "8,16,24,32,40", "distances of the relative error [m], separated by commas");
DEFINE_uint32(seed, 1, "seed of the simulation, and of the start that init.method truth draws");
DEFINE_string(set, "", "a.b=value,...: settings over the configuration file; may be repeated");
DEFINE_bool(show, false, "print the resolved configuration with the reason of every key");
DEFINE_string(sp3, "", "precise orbits, SP3, separated by commas");
DEFINE_int32(starts, 100, "starts in all, spread over the sequences of the plan");
DEFINE_string(topics, "",
              "imu=/topic,cam0=/topic,...: names in a bag that are not the usual ones (docs/bags.md)");
DEFINE_string(truth, "", "ground-truth trajectory file");
DEFINE_string(windows, "5,10,15,20,25", "clones in the window, separated by commas");
