#include "eval/calibrate/camera_calibration.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/lie.h"
#include "core/numbers.h"
#include "eval/calibrate/camera_gyro_check.h"
#include "eval/calibrate/camera_gyro_search.h"
#include "eval/calibrate/gyro_correlation.h"
#include "eval/record/runner.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Coordinate = CameraGyroCoordinate;

/// How far the calibration of a lens may be from the given one: a sheet of another program, or a guess.
CameraGyroError PriorOf(const CameraModel& camera, bool readout) {
  CameraGyroError prior = CameraGyroPrior();
  prior[Coordinate::kReadout] = readout ? 0.03 : 0;
  prior[Coordinate::kFocal] = 0.3;
  prior[Coordinate::kFocalRatio] = 0.02;
  prior.segment<2>(Coordinate::kCentre).setConstant(0.03 * camera.width_px());
  switch (camera.model()) {
    case DistortionModel::kNone:
      break;
    case DistortionModel::kRadialTangential:
      prior.segment<4>(Coordinate::kLens) << 0.2, 0.2, 0.005, 0.005;
      break;
    case DistortionModel::kEquidistant:
      prior.segment<4>(Coordinate::kLens).setConstant(0.05);
      break;
    case DistortionModel::kFov:
      prior[Coordinate::kLens] = 0.05;
      break;
    case DistortionModel::kDoubleSphere:  // xi, alpha
      prior.segment<2>(Coordinate::kLens) << 0.1, 0.05;
      break;
    case DistortionModel::kEucm:  // alpha, beta
      prior.segment<2>(Coordinate::kLens) << 0.1, 0.2;
      break;
    case DistortionModel::kMei:  // its coefficients have no derivatives
      break;
  }
  return prior;
}

/// The part of a log between two stamps of the camera's clock.
MeasurementLog Part(const MeasurementLog& log, TimeNs from_ns, TimeNs to_ns) {
  constexpr TimeNs kMarginNs = kSecondNs / 2;
  MeasurementLog part;
  part.rig = log.rig;
  for (const ImuSample& sample : log.imu) {
    if (sample.stamp_ns >= from_ns - kMarginNs && sample.stamp_ns <= to_ns + kMarginNs) {
      part.imu.push_back(sample);
    }
  }
  for (const TrackFrame& frame : log.frames) {
    if (frame.stamp_ns >= from_ns && frame.stamp_ns <= to_ns) {
      part.frames.push_back(frame);
    }
  }
  return part;
}

class Calibration {
 public:
  Calibration(const EstimatorConfig& config, const MeasurementLog& log,
              const CameraCalibrationOptions& options)
      : config_(config), log_(log), options_(options) {
    result_.rig = log.rig;
  }

  Result<CalibratedCamera> Execute() {
    ALIDADE_RETURN_IF_ERROR(FitGeometry());
    result_.rig.camera = result_.fit.model.camera;
    result_.rig.T_BC.rotation = result_.fit.model.R_BC;
    result_.rig.camera_time_offset_s = result_.fit.model.time_offset_s;
    result_.rig.line_delay_s = HasRollingShutter(result_.fit)
                                   ? result_.fit.model.readout_s / result_.fit.model.camera.height_px()
                                   : 0;
    if (options_.lever_arm) {
      FindLeverArm();
    }
    return std::move(result_);
  }

 private:
  void Progress(const std::string& line) const {
    if (options_.progress) {
      options_.progress(line);
    }
  }

  Status FitGeometry() {
    constexpr std::size_t kMostPairs = 600;
    constexpr std::size_t kLeastHalf = 10;
    const LogTables tables = TablesOf(log_);
    const double sheet_offset_s = log_.rig.camera_time_offset_s;
    const GyroCorrelation rates =
        CorrelateGyro(TurnsOfImages(log_.rig.camera, tables.frames), tables.imu, sheet_offset_s);
    if (rates.clocks_differ()) {
      const std::string text = "cam0: " + DescribeClocks(rates, sheet_offset_s);
      if (rates.certain()) {
        return Status::Input(text);
      }
      Progress(text);
      result_.remarks.push_back(text);
    }
    const std::vector<FramePair> pairs = FramePairsOf(log_, kMostPairs);
    CameraGyroSearchOptions search;
    search.prior = PriorOf(log_.rig.camera, options_.readout);
    search.focal_factors = options_.focal_factors;
    Result<CameraGyroFit> fit = FindCameraGyro(pairs, log_.imu, ModelOfSheet(log_.rig), search);
    ALIDADE_RETURN_IF_ERROR(fit.status());
    result_.fit = *std::move(fit);
    AllowForExposure(&result_.fit);
    if (result_.fit.model.gyro_sign < 0) {
      return Status::Input(
          "the gyroscope's rates agree with the rotation of the images only once they are negated: wrong "
          "sign, or an axis of a left-handed system; no sheet can express that");
    }
    Progress(Format("camera and gyroscope: %d pairs, %.2f px", result_.fit.pairs, result_.fit.residual_px));
    const auto middle = pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2);
    const std::array<std::vector<FramePair>, 2> halves = {std::vector<FramePair>(pairs.begin(), middle),
                                                          std::vector<FramePair>(middle, pairs.end())};
    CameraGyroFitOptions options;
    options.prior = search.prior;
    for (std::size_t half = 0; half < halves.size() && pairs.size() >= 2 * kLeastHalf; ++half) {
      const Result<CameraGyroFit> part = FitCameraToGyro(halves[half], log_.imu, result_.fit.model, options);
      ALIDADE_RETURN_IF_ERROR(part.status());
      result_.halves[half] = *part;
      AllowForExposure(&*result_.halves[half]);
    }
    if (result_.halves[0] && result_.halves[1]) {
      UseHalves();
    } else {
      result_.remarks.push_back("the recording is too short to compare the calibrations of its halves");
    }
    return Status::Ok();
  }

  /// A shorter read-out is none, or one that moves nothing.
  static bool HasRollingShutter(const CameraGyroFit& fit) {
    constexpr double kLeastReadoutS = 3e-3, kSigmas = 5;
    return std::abs(fit.model.readout_s) >
           std::max(kLeastReadoutS, kSigmas * fit.deviations[Coordinate::kReadout]);
  }

  /// A camera with a rolling shutter adapts its exposure time as a rule, and half of that moves the time
  /// offset along: one part of a recording predicts another no better than this.
  static void AllowForExposure(CameraGyroFit* fit) {
    constexpr double kExposureStdS = 2e-3;
    if (HasRollingShutter(*fit) && fit->deviations[Coordinate::kReadout] > 0) {
      double& deviation = fit->deviations[Coordinate::kTimeOffset];
      deviation = std::hypot(deviation, kExposureStdS);
    }
  }

  /// The whole is about the mean of the halves, so its error is at least about half of what they differ.
  void UseHalves() {
    const CameraGyroError difference = CameraGyroOffset(result_.halves[0]->model, result_.halves[1]->model);
    for (int c = Coordinate::kRotation; c < Coordinate::kCount; ++c) {  // a bias may drift
      const double deviation = std::hypot(result_.halves[0]->deviations[c], result_.halves[1]->deviations[c]);
      if (deviation > 0 && std::abs(difference[c]) / deviation > result_.halves_sigma) {
        result_.halves_sigma = std::abs(difference[c]) / deviation;
        result_.halves_coordinate = NameOfCoordinate(c).name;
      }
      result_.fit.deviations[c] =
          deviation > 0 ? std::max(result_.fit.deviations[c], std::abs(difference[c]) / 2) : 0;
    }
  }

  /// The lever arm at the end of a run over `part`; empty where there was no run.
  std::optional<std::pair<Vector3d, Vector3d>> RunFor(const MeasurementLog& part) {
    EstimatorConfig config = config_;
    config.calibration.extrinsics = true;
    config.calibration.rotation_std_rad =
        std::max(1e-4, result_.fit.deviations.segment<3>(Coordinate::kRotation).maxCoeff());
    config.calibration.translation_std_m = kPriorM;
    MeasurementLog log = part;
    log.rig = result_.rig;
    const RunResult run = RunEstimator(config, log, options_.run);
    if (run.records.empty() || !run.status.ok() || !run.records.back().calibration || !run.restarts.empty()) {
      Progress("lever arm: " +
               (run.status.ok() ? std::string("the estimator was lost on the way") : run.status.message()));
      return std::nullopt;
    }
    const CalibrationEstimate& last = *run.records.back().calibration;
    return std::pair<Vector3d, Vector3d>(last.mean.T_BC.translation,
                                         last.deviations.segment<3>(last.layout.extrinsics() + 3));
  }

  void FindLeverArm() {
    const TimeNs first = log_.frames.front().stamp_ns, last = log_.frames.back().stamp_ns;
    const TimeNs middle = first + (last - first) / 2;
    const auto whole = RunFor(log_);
    const auto early = RunFor(Part(log_, first, middle));
    const auto late = RunFor(Part(log_, middle, last));
    if (!whole || !early || !late) {
      result_.remarks.push_back(
          "the estimator did not get through the recording and its halves: the lever arm is "
          "that of the sheet");
      return;
    }
    const Vector3d variances = early->second.cwiseAbs2() + late->second.cwiseAbs2();
    const double squares = ((early->first - late->first).cwiseAbs2().array() / variances.array()).mean();
    CameraLeverArm arm{
        whole->first, whole->second * std::sqrt(std::max(1.0, squares)), {early->first, late->first}};
    if (arm.deviations.maxCoeff() > kPriorM / 2) {
      result_.remarks.push_back(
          Format("the lever arm is not observable in this motion (+- %.3f m): it is that of the "
                 "sheet",
                 arm.deviations.maxCoeff()));
      return;
    }
    result_.rig.T_BC.translation = arm.p_BC;
    result_.lever_arm = arm;
  }

  static constexpr double kPriorM = 0.1;

  const EstimatorConfig& config_;
  const MeasurementLog& log_;
  const CameraCalibrationOptions& options_;
  CalibratedCamera result_;
};

}  // namespace

CoordinateName NameOfCoordinate(int coordinate) {
  static const std::array<CoordinateName, Coordinate::kCount> names = {
      {{"gyroscope bias x", "gyro_bias_x", "deg/s", kDegreesPerRadian},
       {"gyroscope bias y", "gyro_bias_y", "deg/s", kDegreesPerRadian},
       {"gyroscope bias z", "gyro_bias_z", "deg/s", kDegreesPerRadian},
       {"rotation about camera x", "rotation_x", "deg", kDegreesPerRadian},
       {"rotation about camera y", "rotation_y", "deg", kDegreesPerRadian},
       {"rotation about camera z", "rotation_z", "deg", kDegreesPerRadian},
       {"time offset", "time_offset", "ms", 1e3},
       {"readout time", "readout", "ms", 1e3},
       {"focal length", "focal", "%", 100},
       {"ratio fu / fv", "focal_ratio", "%", 100},
       {"principal point u", "cu", "px", 1},
       {"principal point v", "cv", "px", 1},
       {"lens coefficient 0", "k_0", "", 1},
       {"lens coefficient 1", "k_1", "", 1},
       {"lens coefficient 2", "k_2", "", 1},
       {"lens coefficient 3", "k_3", "", 1},
       {"lens coefficient 4", "k_4", "", 1}}};
  return names[static_cast<std::size_t>(coordinate)];
}

Result<CalibratedCamera> CalibrateCamera(const EstimatorConfig& config, const MeasurementLog& log,
                                         const CameraCalibrationOptions& options) {
  return Calibration(config, log, options).Execute();
}

}  // namespace alidade
