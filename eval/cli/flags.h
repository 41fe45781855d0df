#pragma once

#include <gflags/gflags.h>

// Every flag of the program; eval/cli/commands.cc says which command takes which. The only folder that knows
// gflags.
DECLARE_string(align);
DECLARE_bool(anchor_at_first);
DECLARE_double(align_share);
DECLARE_string(association);
DECLARE_bool(audit);
DECLARE_string(backend);
DECLARE_string(calibration);
DECLARE_string(camera);
DECLARE_string(catalogue);
DECLARE_bool(check);
DECLARE_string(clk);
DECLARE_string(compression);
DECLARE_string(config);
DECLARE_string(data);
DECLARE_string(dataset);
DECLARE_bool(diff);
DECLARE_string(error);
DECLARE_string(estimate);
DECLARE_string(estimator);
DECLARE_bool(imu_scale);
DECLARE_string(input);
DECLARE_string(export);
DECLARE_string(figures);
DECLARE_bool(interpolate);
DECLARE_int32(jobs);
DECLARE_bool(json);
DECLARE_string(kind);
DECLARE_double(limit);
DECLARE_double(max_dt);
DECLARE_bool(list);
DECLARE_string(mirror);
DECLARE_string(model);
DECLARE_bool(motion);
DECLARE_string(nav);
DECLARE_string(obs);
DECLARE_string(output);
DECLARE_int32(overlay);
DECLARE_bool(overwrite);
DECLARE_string(plan);
DECLARE_bool(quiet);
DECLARE_bool(render);
DECLARE_bool(resume);
DECLARE_string(rpe);
DECLARE_bool(rpe_all_pairs);
DECLARE_string(rpe_by);
DECLARE_bool(rpe_pairs_from_truth);
DECLARE_double(rpe_tolerance);
DECLARE_string(rpe_unit);
DECLARE_bool(score);
DECLARE_uint32(seed);
DECLARE_string(set);
DECLARE_bool(show);
DECLARE_string(sp3);
DECLARE_int32(starts);
DECLARE_double(time_offset);
DECLARE_string(topics);
DECLARE_string(tracks);
DECLARE_string(truth);
DECLARE_double(truth_rate);
DECLARE_double(truth_std_deg);
DECLARE_double(truth_std_m);
DECLARE_string(windows);
