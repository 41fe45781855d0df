#include "eval/calibrate/camera_gyro_check.h"

#include <array>
#include <cmath>
#include <string>

#include "core/format.h"
#include "core/lie.h"
#include "core/numbers.h"
#include "eval/calibrate/camera_gyro_search.h"
#include "eval/calibrate/gyro_correlation.h"
#include "eval/dataset/imu_units.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Coordinate = CameraGyroCoordinate;

constexpr double kSigmas = 5;

double Angle(const Matrix3d& a, const Matrix3d& b) {
  return so3::Log(a.transpose() * b).norm() * kDegreesPerRadian;
}

/// "x right, y down, z forward" in words of the body: the body axis next to each camera axis.
std::string AxesText(const Matrix3d& R_BC) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    int largest = 0;
    R_BC.col(axis).cwiseAbs().maxCoeff(&largest);
    text += Format("%scamera %s = body %s%s", axis == 0 ? "" : ", ", kNames[static_cast<std::size_t>(axis)],
                   R_BC(largest, axis) < 0 ? "-" : "", kNames[static_cast<std::size_t>(largest)]);
  }
  return text;
}

/// Clocks far apart, and rates in another unit: neither leaves anything to compare.
bool ReportClocksOrUnit(const RigCalibration& rig, const GyroCorrelation& rates, Findings* findings) {
  constexpr double kUnitBand = 1.4;  // focal length and translation change the images' rate by less
  if (rates.clocks_differ()) {
    const std::string text = "cam0: " + DescribeClocks(rates, rig.camera_time_offset_s);
    if (rates.certain()) {
      findings->Error(text);
    } else {
      findings->Warning(text + Format("; from %.0f s of turns", rates.best.span_s));
    }
    return true;
  }
  if (!rates.agree() || !(rates.best.scale > 0)) {
    return false;
  }
  const ImuUnit* unit = NearestUnit(kGyroUnits, rates.best.scale, 1, kUnitBand);
  if (unit == nullptr || unit == kGyroUnits) {
    return false;
  }
  findings->Error(
      Format("imu0: the gyroscope's rates are %.4g times the rotation rate of the images (correlation %.2f): "
             "the gyroscope seems to be in %s, expected rad/s",
             rates.best.scale, rates.best.correlation, unit->name));
  return true;
}

/// The one axis of the gyroscope that is negated, when T_BS of the sheet is right: a gyroscope D w of true
/// rates w agrees as -D w with a camera at -D R_BC. Empty: all axes, or something else.
std::string NegatedAxis(const Matrix3d& R_BC_sheet, const Matrix3d& R_BC_found) {
  constexpr double kSameDeg = 15;
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d turn = Vector3d::Constant(-1);
    turn[axis] = 1;
    if (Angle(turn.asDiagonal() * R_BC_sheet, R_BC_found) < kSameDeg) {
      return kNames[static_cast<std::size_t>(axis)];
    }
  }
  return "";
}

/// Other axes than the sheet's; nothing else is compared then.
bool ReportAxes(const CameraGyroModel& sheet, const CameraGyroFit& fit, Findings* findings) {
  constexpr double kOtherAxesDeg = 30;
  constexpr double kSameDeg = 15;
  constexpr double kMostStdDeg = 3;
  const CameraGyroModel& found = fit.model;
  if (fit.deviations.segment<3>(Coordinate::kRotation).maxCoeff() * kDegreesPerRadian > kMostStdDeg) {
    return false;  // little rotation in the recording
  }
  if (found.gyro_sign < 0) {
    const std::string axis = NegatedAxis(sheet.R_BC, found.R_BC);
    findings->Error(
        "imu0: the gyroscope's rates contradict the rotation of the images and agree with it once " +
        (axis.empty() ? "they are negated" : "the " + axis + " axis of the gyroscope is negated") +
        ": wrong sign, or an axis of a left-handed system");
    return true;
  }
  const double angle_deg = Angle(sheet.R_BC, found.R_BC);
  if (angle_deg < kOtherAxesDeg) {
    return false;
  }
  if (Angle(sheet.R_BC.transpose(), found.R_BC) < kSameDeg) {
    findings->Error(
        Format("cam0: T_BS is the inverse of the rotation found from images and gyroscope (body to camera "
               "instead of camera to body; %.0f deg away)",
               angle_deg));
  } else {
    findings->Error(
        Format("cam0: T_BS has other axes than the rotation found from images and gyroscope, %.0f deg away; "
               "found: %s",
               angle_deg, AxesText(found.R_BC).c_str()));
  }
  return true;
}

void ReportDifferences(const CameraGyroModel& sheet, const CameraGyroFit& fit, Findings* findings) {
  constexpr double kTimeS = 2e-3, kRotationDeg = 0.5, kFocal = 0.01, kReadoutS = 3e-3;
  const double time_s = fit.model.time_offset_s - sheet.time_offset_s;
  const double time_std_s = fit.deviations[Coordinate::kTimeOffset];
  if (std::abs(time_s) > kTimeS && std::abs(time_s) > kSigmas * time_std_s) {
    findings->Warning(
        Format("cam0: time_offset_s: images and gyroscope agree at %.4f +- %.4f s, the sheet has %.4f",
               fit.model.time_offset_s, time_std_s, sheet.time_offset_s));
  }
  const Vector3d turn = so3::Log(sheet.R_BC.transpose() * fit.model.R_BC) * kDegreesPerRadian;
  const Vector3d turn_std = fit.deviations.segment<3>(Coordinate::kRotation) * kDegreesPerRadian;
  if (turn.norm() > kRotationDeg && (turn.cwiseAbs().array() > kSigmas * turn_std.array()).any()) {
    findings->Warning(
        Format("cam0: T_BS: images and gyroscope agree with the camera turned by (%.2f, %.2f, %.2f) +- "
               "(%.2f, %.2f, %.2f) deg about its axes",
               turn.x(), turn.y(), turn.z(), turn_std.x(), turn_std.y(), turn_std.z()));
  }
  const double focal = fit.model.camera.intrinsics()[0] / sheet.camera.intrinsics()[0] - 1;
  const double focal_std = fit.deviations[Coordinate::kFocal];
  if (std::abs(focal) > kFocal && std::abs(focal) > kSigmas * focal_std) {
    findings->Warning(
        Format("cam0: intrinsics: images and gyroscope agree at a focal length %+.1f +- %.1f %% of the "
               "sheet's (fu %.1f px instead of %.1f), or at a gyroscope scaled by as much",
               100 * focal, 100 * focal_std, fit.model.camera.intrinsics()[0], sheet.camera.intrinsics()[0]));
  }
  const double readout_s = fit.model.readout_s;
  const double of_sheet_s = sheet.readout_s;
  if (std::abs(readout_s - of_sheet_s) > kReadoutS &&
      std::abs(readout_s - of_sheet_s) > kSigmas * fit.deviations[Coordinate::kReadout]) {
    findings->Warning(
        Format("cam0: rolling shutter: images and gyroscope agree with the rows of an image exposed over "
               "%.1f +- %.1f ms, by line_delay_s of the sheet over %.1f",
               1e3 * readout_s, 1e3 * fit.deviations[Coordinate::kReadout], 1e3 * of_sheet_s));
  }
}

}  // namespace

std::vector<FramePair> FramePairsOf(const MeasurementLog& log, std::size_t most) {
  return FramePairsOf(log.rig, TablesOf(log), most);
}

std::vector<FramePair> FramePairsOf(const RigCalibration& rig, const LogTables& tables, std::size_t most) {
  constexpr double kFlowShare = 0.1;  // of the image's width
  FramePairOptions options;
  options.least_flow_px = kFlowShare * rig.camera.width_px();
  return ChooseFramePairs(tables, options, most);
}

CameraGyroModel ModelOfSheet(const RigCalibration& rig) {
  CameraGyroModel model;
  model.camera = rig.camera;
  model.R_BC = rig.T_BC.rotation;
  model.time_offset_s = rig.camera_time_offset_s;
  model.readout_s = rig.line_delay_s * rig.camera.height_px();
  return model;
}

void CheckCameraAgainstGyro(const MeasurementLog& log, std::size_t most_pairs, Findings* findings) {
  CheckCameraAgainstGyro(log.rig, TablesOf(log), most_pairs, findings);
}

void CheckCameraAgainstGyro(const RigCalibration& rig, const LogTables& tables, std::size_t most_pairs,
                            Findings* findings) {
  constexpr double kMarginS = 2;    // beyond what the fit takes
  constexpr double kMostScale = 5;  // no error of the camera's sheet explains more
  const CameraGyroModel sheet = ModelOfSheet(rig);
  const GyroCorrelation rates =
      CorrelateGyro(TurnsOfImages(rig.camera, tables.frames), tables.imu, sheet.time_offset_s);
  if (ReportClocksOrUnit(rig, rates, findings)) {
    return;
  }
  if (rates.best.scale > kMostScale) {
    findings->Fact(
        Format("cam0 against the gyroscope: not compared: its rates are %.3g times those of the "
               "images, and vary %s (correlation %.2f)",
               rates.best.scale, rates.agree() ? "alike: a unit that is not known?" : "otherwise",
               rates.best.correlation));
    return;
  }
  CameraGyroSearchOptions options;
  options.prior[Coordinate::kFocal] = 0.3;
  options.prior[Coordinate::kReadout] = 0.03;
  const std::vector<FramePair> pairs = FramePairsOf(rig, tables, most_pairs);
  const std::vector<ImuSample> imu =
      SamplesAround(pairs, tables.imu, kMarginS + std::abs(sheet.time_offset_s));
  const Result<CameraGyroFit> fit = FindCameraGyro(pairs, imu, sheet, options);
  if (!fit.ok()) {
    findings->Fact("cam0 against the gyroscope: not compared: " + fit.message());
    return;
  }
  findings->Fact(Format(
      "cam0 against the gyroscope: %d pairs of images, %.2f px from the epipolar lines, %.0f %% "
      "outliers; time offset %+.4f +- %.4f s from the sheet's, rotation %.2f deg, focal length %+.2f "
      "+- %.2f %%",
      fit->pairs, fit->residual_px, 100 * fit->outliers, fit->model.time_offset_s - sheet.time_offset_s,
      fit->deviations[Coordinate::kTimeOffset], Angle(sheet.R_BC, fit->model.R_BC),
      100 * (fit->model.camera.intrinsics()[0] / sheet.camera.intrinsics()[0] - 1),
      100 * fit->deviations[Coordinate::kFocal]));
  if (!ReportAxes(sheet, *fit, findings)) {
    ReportDifferences(sheet, *fit, findings);
  }
}

}  // namespace alidade
