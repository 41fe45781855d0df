#pragma once

#include <type_traits>

#include "eval/comparison/cell_report.h"

namespace alidade {

// The fields of a CellReport and of its parts: every field once, so that the same list writes and reads.
// `field` is called with the name and the value of each.

template <typename T, typename Plain>
concept Is = std::is_same_v<std::remove_const_t<T>, Plain>;

template <Is<RpeResult> T>
void Fields(T& x, auto&& field) {
  field("distance_m", x.distance_m);
  field("count", x.count);
  field("pos_rmse_m", x.pos_rmse_m);
  field("ori_rmse_deg", x.ori_rmse_deg);
  field("pos_errors_m", x.pos_errors_m);
}

template <Is<InnovationSummary> T>
void Fields(T& x, auto&& field) {
  field("ratio", x.ratio);
  field("inside", x.inside);
  field("band", x.band);
}

template <Is<SkyTrack> T>
void Fields(T& x, auto&& field) {
  field("satellite", x.satellite);
  field("time_s", x.time_s);
  field("azimuth_deg", x.azimuth_deg);
  field("elevation_deg", x.elevation_deg);
  field("residual_m", x.residual_m);
  field("used_share", x.used_share);
  field("rms_m", x.rms_m);
}

template <Is<CellSeries> T>
void Fields(T& x, auto&& field) {
  field("regular", x.regular);
  field("time_s", x.time_s);
  field("truth_position", x.truth_position);
  field("position", x.position);
  field("error", x.error);
  field("sigma", x.sigma);
  field("nees_pose", x.nees_pose);
  field("backend_ms", x.backend_ms);
  field("features_used", x.features_used);
  field("tracks_in", x.tracks_in);
  field("nis_ratio", x.nis_ratio);
  field("sensor_nis_ratio", x.sensor_nis_ratio);
  field("rank", x.rank);
  field("yaw_leak", x.yaw_leak);
  field("position_leak", x.position_leak);
}

template <Is<CellResult> T>
void Fields(T& x, auto&& field) {
  field("estimator", x.estimator);
  field("backend", x.backend);
  field("smoothed", x.smoothed);
  field("sequence", x.sequence);
  field("seed", x.seed);
  field("status", x.status);
  field("message", x.message);
  field("input_digest", x.input_digest);
  field("frames", x.frames);
  field("duration_s", x.duration_s);
  field("completion", x.completion);
  field("path_m", x.path_m);
  field("rmse_pos_m", x.rmse_pos_m);
  field("rmse_ori_deg", x.rmse_ori_deg);
  field("ate_pos_m", x.ate_pos_m);
  field("ate_ori_deg", x.ate_ori_deg);
  field("align", x.align);
  field("rpe", x.rpe);
  field("nees_pose", x.nees_pose);
  field("nees_ori", x.nees_ori);
  field("nees_pos", x.nees_pos);
  field("coverage_3sigma", x.coverage_3sigma);
  field("nees_vel", x.nees_vel);
  field("nees_gyro_bias", x.nees_gyro_bias);
  field("nees_accel_bias", x.nees_accel_bias);
  field("truth_has_covariance", x.truth_has_covariance);
  field("frontend_ms", x.frontend_ms);
  field("backend_ms", x.backend_ms);
  field("backend_ms_p95", x.backend_ms_p95);
  field("realtime_factor", x.realtime_factor);
  field("features_per_frame", x.features_per_frame);
  field("propagate_ms", x.propagate_ms);
  field("update_ms", x.update_ms);
  field("innovations", x.innovations);
  field("sensor_innovations", x.sensor_innovations);
  field("gated_share", x.gated_share);
  field("silent_s", x.silent_s);
  field("alarm_inside_share", x.alarm_inside_share);
  field("sigma_pos_m", x.sigma_pos_m);
  field("sigma_ori_deg", x.sigma_ori_deg);
  field("filtering_sigma_pos_m", x.filtering_sigma_pos_m);
  field("filtering_sigma_ori_deg", x.filtering_sigma_ori_deg);
  field("calibration_rotation_deg", x.calibration_rotation_deg);
  field("calibration_translation_m", x.calibration_translation_m);
  field("calibration_time_ms", x.calibration_time_ms);
  field("restarts", x.restarts);
  field("series", x.series);
  field("sky", x.sky);
}

template <Is<FrontendSummary> T>
void Fields(T& x, auto&& field) {
  field("sequence", x.sequence);
  field("seed", x.seed);
  field("images", x.images);
  field("tracks", x.tracks);
  field("features_per_frame", x.features_per_frame);
  field("median_length", x.median_length);
  field("mean_length", x.mean_length);
  field("lost_share", x.lost_share);
  field("rejected_share", x.rejected_share);
  field("thinned_share", x.thinned_share);
  field("mean_ms", x.mean_ms);
  field("p95_ms", x.p95_ms);
}

template <Is<CellReport> T>
void Fields(T& x, auto&& field) {
  field("result", x.result);
  field("digest", x.digest);
  field("reused", x.reused);
  field("frontend", x.frontend);
  field("remarks", x.remarks);
}

}  // namespace alidade
