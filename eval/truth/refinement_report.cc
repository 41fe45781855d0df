#include "eval/truth/refinement_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/format.h"
#include "core/numbers.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

/// The constants in the units of the report, with their standard deviations.
struct ConstantRow {
  const char* key;
  const char* text;
  std::vector<double> values;
  std::vector<double> deviations;
};

std::vector<ConstantRow> ConstantRows(const RefinedTruth& refined) {
  const TruthConstants& constants = refined.constants;
  const Eigen::Vector3d tilt = so3::Log(constants.R_TW);
  const Eigen::Vector3d marker = so3::Log(constants.T_BM.rotation);
  const Eigen::Vector3d& lever = constants.T_BM.translation;
  const TruthConstantsError sigma = refined.constants_covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const auto row = [&](const char* key, const char* text, const Eigen::Vector3d& values, int column,
                       int count, double unit) {
    ConstantRow result{key, text, {}, {}};
    for (int i = 0; i < count; ++i) {
      result.values.push_back(unit * values[i]);
      result.deviations.push_back(unit * sigma[column + i]);
    }
    return result;
  };
  std::vector<ConstantRow> rows = {
      row("tilt_deg", "tilt of the truth's frame [deg]", tilt, kTiltColumn, 2, kDegreesPerRadian),
      row("marker_rotation_deg", "rotation of the marker [deg]", marker, kMarkerColumn, 3, kDegreesPerRadian),
      row("lever_arm_mm", "lever arm of the marker [mm]", lever, kLeverColumn, 3, 1e3),
      row("time_offset_ms", "t_imu - t_truth [ms]", Eigen::Vector3d(constants.time_offset_s, 0, 0),
          kTimeColumn, 1, 1e3)};
  if (!refined.imu_scale_std.isZero(0)) {
    const auto scale = [&](const char* key, const char* text, const Eigen::Vector3d& values, int first) {
      ConstantRow result{key, text, {}, {}};
      for (int i = 0; i < 3; ++i) {
        result.values.push_back(1e3 * values[i]);
        result.deviations.push_back(1e3 * refined.imu_scale_std[first + i]);
      }
      return result;
    };
    rows.push_back(scale("gyro_scale_permille", "scale of the gyroscope [1e-3]", refined.imu_scale.gyro, 0));
    rows.push_back(
        scale("accel_scale_permille", "scale of the accelerometer [1e-3]", refined.imu_scale.accel, 3));
  }
  return rows;
}

struct FitRow {
  const char* key;
  const char* text;
  const TruthFit* fit;
};

std::vector<FitRow> FitRows(const RefinedTruth& refined) {
  return {{"truth_orientation", "truth, orientation", &refined.orientation},
          {"truth_position", "truth, position", &refined.position},
          {"gyro", "gyroscope", &refined.gyro},
          {"accel", "accelerometer", &refined.accel},
          {"gyro_walk", "gyroscope bias walk", &refined.gyro_walk},
          {"accel_walk", "accelerometer bias walk", &refined.accel_walk}};
}

/// Root mean square of the deviations of the refined poses: orientation [rad], position [m].
TruthNoise MeanDeviation(const RefinedTruth& refined) {
  TruthNoise squares;
  for (const NavEstimate& state : refined.states) {
    squares.orientation_rad += state.covariance.diagonal().head<3>().sum() / 3;
    squares.position_m += state.covariance.diagonal().segment<3>(3).sum() / 3;
  }
  const double count = static_cast<double>(std::max<size_t>(refined.states.size(), 1));
  return {std::sqrt(squares.orientation_rad / count), std::sqrt(squares.position_m / count)};
}

double LongestSpan(const RefinedTruth& refined) {
  double longest_s = 0;
  for (const TruthSpan& span : refined.spans) {
    longest_s = std::max(longest_s, SecondsBetween(span.from_ns, span.to_ns));
  }
  return longest_s;
}

Json NoiseJson(double value, double deviation, double correlation_poses) {
  return {{"std", value}, {"deviation", deviation}, {"correlation_poses", correlation_poses}};
}

}  // namespace

std::string FormatRefinementText(const RefinedTruth& refined) {
  std::string text = Format("%zu states, %zu poses of the truth used, %zu refused\n", refined.states.size(),
                            refined.poses - refined.refused, refined.refused);
  text += Format("%zu spans without truth, the longest %.2f s; %d gaps of the IMU\n", refined.spans.size(),
                 LongestSpan(refined), refined.imu_gaps);
  for (const ConstantRow& row : ConstantRows(refined)) {
    text += Format("%-34s", row.text);
    for (size_t i = 0; i < row.values.size(); ++i) {
      text += Format("%12.4f +- %.4f", row.values[i], row.deviations[i]);
    }
    text += "\n";
  }
  const TruthNoise deviation = MeanDeviation(refined);
  text += Format("%-34s%12.4f +- %.4f deg%12.4f +- %.4f mm\n", "noise of the truth, one axis",
                 kDegreesPerRadian * refined.noise.orientation_rad,
                 kDegreesPerRadian * refined.noise_std.orientation_rad, 1e3 * refined.noise.position_m,
                 1e3 * refined.noise_std.position_m);
  text += Format("%-34s%12.1f poses %18.1f poses\n", "its correlation (1: white)",
                 refined.orientation_correlation, refined.position_correlation);
  text += Format("%-34s%12.4f deg%21.4f mm\n", "deviation of a refined pose",
                 kDegreesPerRadian * deviation.orientation_rad, 1e3 * deviation.position_m);
  text += Format("\n%-34s%14s%12s%10s%16s\n", "normalised residuals", "chi-square", "dof", "ratio",
                 "noise factor");
  for (const FitRow& row : FitRows(refined)) {
    text += Format("%-34s%14.1f%12.1f%10.3f%16.2f\n", row.text, row.fit->chi_square, row.fit->dof,
                   row.fit->ratio(), std::sqrt(row.fit->ratio()));
  }
  return text;
}

std::string FormatRefinementJson(const RefinedTruth& refined, const Dataset& dataset,
                                 const RefineOptions& options) {
  Json object;
  object["dataset"] = dataset.name;
  object["truth"] = dataset.truth_path;
  object["truth_rate_hz"] = options.truth_rate_hz;
  object["given_noise"] = {{"orientation_rad", options.noise.orientation_rad},
                           {"position_m", options.noise.position_m}};
  object["imu"] = {{"noise_scale", options.imu.noise_scale},
                   {"random_walk_scale", options.imu.random_walk_scale},
                   {"gravity_mps2", options.imu.gravity_mps2}};
  object["states"] = refined.states.size();
  object["poses"] = refined.poses;
  object["poses_refused"] = refined.refused;
  object["imu_gaps"] = refined.imu_gaps;
  for (const ConstantRow& row : ConstantRows(refined)) {
    object["constants"][row.key] = {{"value", row.values}, {"std", row.deviations}};
  }
  object["noise_orientation_rad"] = NoiseJson(
      refined.noise.orientation_rad, refined.noise_std.orientation_rad, refined.orientation_correlation);
  object["noise_position_m"] =
      NoiseJson(refined.noise.position_m, refined.noise_std.position_m, refined.position_correlation);
  const TruthNoise deviation = MeanDeviation(refined);
  object["refined_std"] = {{"orientation_rad", deviation.orientation_rad},
                           {"position_m", deviation.position_m}};
  for (const FitRow& row : FitRows(refined)) {
    object["fit"][row.key] = {
        {"chi_square", row.fit->chi_square}, {"dof", row.fit->dof}, {"ratio", row.fit->ratio()}};
  }
  object["spans_without_truth_ns"] = Json::array();
  for (const TruthSpan& span : refined.spans) {
    object["spans_without_truth_ns"].push_back({span.from_ns, span.to_ns});
  }
  object["iterations"] = refined.iterations;
  object["distance_sigma"] = refined.distance_sigma;
  return object.dump(2) + "\n";
}

}  // namespace alidade
