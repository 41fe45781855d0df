#include "eval/simulation/sim_hybrid.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "eval/dataset/dataset_reader.h"
#include "eval/simulation/gyro_agreement.h"
#include "eval/simulation/recorded_motion.h"
#include "eval/simulation/sim_camera.h"
#include "eval/simulation/sim_gnss.h"
#include "eval/simulation/sim_rig.h"

namespace alidade {
namespace {

constexpr double kImuLeadSeconds = 3;
// Far above what truth noise (0.02 rad/s in motion capture) and vibration leave, far below what a wrong body
// frame or clock does: that residual is larger than the motion itself.
constexpr double kMaxGyroResidualFraction = 0.5;
constexpr double kGyroNoiseAllowance = 0.1;  // rad/s
constexpr double kMaxTimeOffsetSeconds = 0.05;

/// Stamps of the camera, whichever way the folder gives them.
std::vector<TimeNs> CameraStamps(const Dataset& dataset) {
  std::vector<TimeNs> stamps = dataset.camera_stamps;
  if (stamps.empty()) {
    for (const ImageEntry& image : dataset.images) {
      stamps.push_back(image.stamp_ns);
    }
  }
  if (stamps.empty()) {
    for (const TrackFrame& frame : dataset.frames) {
      stamps.push_back(frame.stamp_ns);
    }
  }
  return stamps;
}

/// Those exposed within both [first, last] and the IMU samples.
std::vector<TimeNs> UsableStamps(const Dataset& dataset, TimeNs first_ns, TimeNs last_ns) {
  first_ns = std::max(first_ns, dataset.imu.front().stamp_ns);
  last_ns = std::min(last_ns, dataset.imu.back().stamp_ns);
  const TimeNs offset_ns = SecondsToNs(dataset.rig.camera_time_offset_s);
  std::vector<TimeNs> stamps = CameraStamps(dataset);
  std::erase_if(stamps,
                [&](TimeNs stamp) { return stamp + offset_ns < first_ns || stamp + offset_ns > last_ns; });
  return stamps;
}

/// Drops the IMU samples that no frame needs.
void TrimImu(TimeNs first_frame_ns, TimeNs last_exposure_ns, std::vector<ImuSample>* imu) {
  const TimeNs first_ns = first_frame_ns - SecondsToNs(kImuLeadSeconds);
  const auto earlier = [](const ImuSample& sample, TimeNs stamp) { return sample.stamp_ns < stamp; };
  const auto last = std::lower_bound(imu->begin(), imu->end(), last_exposure_ns, earlier);
  imu->erase(last == imu->end() ? last : last + 1, imu->end());
  imu->erase(imu->begin(), std::lower_bound(imu->begin(), imu->end(), first_ns, earlier));
}

/// The camera moves along the truth itself, so that what is unknown of the real motion is no error of it.
Trajectory Exactly(Trajectory truth) {
  truth.has_covariance = false;
  for (TrajectoryPoint& point : truth.points) {
    point.covariance.setZero();
  }
  return truth;
}

Status CheckGyro(const RecordedMotion& recorded, const std::vector<ImuSample>& imu) {
  const Result<GyroAgreement> gyro = CompareGyro(recorded.motion, recorded.motion.start_ns(), imu);
  if (!gyro.ok()) {
    return {gyro.code(), recorded.path + ": " + gyro.message()};
  }
  const double limit_radps = kMaxGyroResidualFraction * gyro->motion_rms_radps + kGyroNoiseAllowance;
  if (gyro->residual_rms_radps > limit_radps) {
    return Status::Input(recorded.path + ": the gyroscope differs from this motion by " +
                         std::to_string(gyro->residual_rms_radps) + " rad/s rms, expected less than " +
                         std::to_string(limit_radps) + " (another body frame, another clock?)");
  }
  if (std::abs(gyro->time_offset_s) > kMaxTimeOffsetSeconds) {
    return Status::Input(recorded.path + ": stamped " + std::to_string(gyro->time_offset_s) +
                         " s late by the gyroscope, expected at most " +
                         std::to_string(kMaxTimeOffsetSeconds) + " s either way");
  }
  return Status::Ok();
}

}  // namespace

Result<Simulation> SimulateHybrid(const SimulatorConfig& config, unsigned seed) {
  const Result<Dataset> real = ReadDataset(config.hybrid_dataset);
  ALIDADE_RETURN_IF_ERROR(real.status());
  Result<RecordedMotion> recorded = LoadRecordedMotion(config.hybrid_dataset, config);
  ALIDADE_RETURN_IF_ERROR(recorded.status());
  const SplineTrajectory& motion = recorded->motion;
  ALIDADE_RETURN_IF_ERROR(CheckGyro(*recorded, real->imu));
  const std::vector<TimeNs> stamps =
      UsableStamps(*real, motion.start_ns(), recorded->samples.points.back().stamp_ns);
  if (stamps.empty()) {
    return Status::Input(config.hybrid_dataset + ": no camera stamp within the truth " + recorded->path +
                         ", expected some");
  }

  Simulation simulation;
  Dataset& dataset = simulation.dataset;
  dataset.name = config.name;
  dataset.rig = real->rig;
  dataset.rig.line_delay_s = SimLineDelay(config, real->rig.line_delay_s);
  dataset.imu_rate_hz = real->imu_rate_hz;
  dataset.camera_rate_hz = real->camera_rate_hz;
  dataset.imu = real->imu;
  TrimImu(stamps.front(), stamps.back() + SecondsToNs(real->rig.camera_time_offset_s), &dataset.imu);
  dataset.camera_stamps = stamps;
  if (!config.render.enabled) {
    ALIDADE_RETURN_IF_ERROR(AddSimulatedTracks(config, motion, motion.start_ns(), seed, &dataset));
  }
  ALIDADE_RETURN_IF_ERROR(AddSimulatedGnss(config, motion, motion.start_ns(), seed, &dataset));
  dataset.truth = Exactly(std::move(recorded->samples));
  dataset.truth_path = recorded->path;
  simulation.motion_start_ns = motion.start_ns();
  simulation.motion = std::make_shared<SplineTrajectory>(std::move(recorded->motion));
  return simulation;
}

}  // namespace alidade
