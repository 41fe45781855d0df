#include "eval/peers/open_vins/system.h"

#include <feat/FeatureDatabase.h>
#include <state/State.h>
#include <state/StateHelper.h>
#include <utils/sensor_data.h>

#include <algorithm>
#include <cmath>

#include "core/cpu_time.h"
#include "eval/peers/open_vins/trackers.h"
#include "eval/peers/open_vins/vio_names.h"

#ifndef ALIDADE_SQRT_VINS
// In place of VioManager::retriangulate_active_tracks (linked with --wrap): it serves drawing alone, and
// would cost as much as the update with eleven clones.
extern "C" void __wrap__ZN8ov_msckf10VioManager27retriangulate_active_tracksERKN7ov_core10CameraDataE(
    ov_msckf::VioManager*, const ov_core::CameraData&) {}
#endif

namespace alidade::open_vins {
namespace {

constexpr double kClockStart = 1000;

}  // namespace

System::System(vio::VioManagerOptions options, const PeerSequence& sequence)
    : VioManager(options), sequence_(sequence) {
  const Cameras& cameras = CamerasOf(*state);
  // Initialiser and zero velocity updates read this database too.
  const std::shared_ptr<ov_core::FeatureDatabase> database = trackFEATS->get_feature_database();
  if (sequence.from_tracks) {
    trackFEATS = std::make_shared<GivenTracks>(cameras, database, &given_);
  } else {
    trackFEATS = std::make_shared<TimedKlt>(cameras, params, database, &frontend_s_);
  }
}

double System::TimeOf(TimeNs stamp_ns) const {
  return kClockStart + SecondsBetween(sequence_.dataset.imu.front().stamp_ns, stamp_ns);
}

Status System::StartFromTruth() {
  const std::optional<Trajectory>& truth = sequence_.dataset.truth;
  if (!truth || !truth->has_velocity || !truth->has_bias) {
    return Status::Input(sequence_.dataset.path + ": has no truth with velocity and biases to start from");
  }
  const auto row = std::find_if(truth->points.begin(), truth->points.end(), [&](const TrajectoryPoint& p) {
    return p.stamp_ns >= sequence_.dataset.imu.front().stamp_ns;
  });
  if (row == truth->points.end()) {
    return Status::Input(sequence_.dataset.path + ": its truth ends before its IMU begins");
  }
  start_ = TimeOf(row->stamp_ns) - static_cast<double>(params.calib_camimu_dt);
  // JPL's global to IMU has the numbers of Hamilton's IMU to global.
  const Eigen::Quaterniond q_WB(row->nav.R_WB);
  Eigen::Matrix<double, 17, 1> initial;
  initial << start_, q_WB.coeffs(), row->nav.p_WB, row->nav.v_WB, row->bias.gyro, row->bias.accel;
  initialize_with_gt(initial);
#ifdef ALIDADE_SQRT_VINS
  // It hands over its prior as a matrix where the deviations are asked for, which leaves the biases without
  // any.
  VecX deviations = VecX::Constant(state->imu->size(), 0.02F);
  deviations.head<3>().setConstant(0.017F);
  deviations.segment<3>(3).setConstant(0.05F);
  deviations.segment<3>(6).setConstant(0.01F);
  vio::StateHelper::set_initial_imu_square_root_covariance(state, deviations);
#endif
  trackFEATS->set_num_features(params.num_pts);
  return Status::Ok();
}

Result<cv::Mat> System::ImageOf(size_t frame) {
  const CameraModel& camera = sequence_.dataset.rig.camera;
  if (sequence_.from_tracks) {
    return cv::Mat(cv::Mat::zeros(camera.height_px(), camera.width_px(), CV_8UC1));
  }
  Result<GreyImage> image = images_.ReadFor(camera, sequence_.dataset.images[frame]);
  ALIDADE_RETURN_IF_ERROR(image.status());
  return cv::Mat(image->height_px, image->width_px, CV_8UC1, image->pixels.data()).clone();
}

Status System::FeedFrame(size_t frame) {
  ov_core::CameraData message;
  message.timestamp = TimeOf(sequence_.frames_ns[frame]);
  if (message.timestamp <= start_) {
    return Status::Ok();
  }
  const Result<cv::Mat> image = ImageOf(frame);
  ALIDADE_RETURN_IF_ERROR(image.status());
  message.sensor_ids = {0};
  message.images = {*image};
  message.masks = {cv::Mat::zeros(image->size(), CV_8UC1)};
  given_ = sequence_.from_tracks ? &sequence_.dataset.frames[frame] : nullptr;
  frontend_s_ = 0;
  const double before = ProcessCpuSeconds();
  feed_measurement_camera(message);
  Record(frame, ProcessCpuSeconds() - before + imu_s_);
  imu_s_ = 0;
  return Status::Ok();
}

void System::Record(size_t frame, double total_s) {
  if (!is_initialized_vio || TimestampOf(*state) != TimeOf(sequence_.frames_ns[frame])) {
    return;
  }
  ov_type::IMU& imu = ImuOf(*state);
  TrajectoryPoint point;
  point.stamp_ns = sequence_.frames_ns[frame] + SecondsToNs(TimeOffsetOf(*state));
  const Eigen::Vector4d q = imu.quat().cast<double>();
  point.nav.R_WB = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  point.nav.p_WB = imu.pos().cast<double>();
  point.nav.v_WB = imu.vel().cast<double>();
  point.bias.gyro = imu.bias_g().cast<double>();
  point.bias.accel = imu.bias_a().cast<double>();
  // Its error R_GI = (1 - [theta]x) R_GI^ is R_WB = R_WB^ Exp(theta): the canonical chart.
  point.covariance =
      vio::StateHelper::get_marginal_covariance(state, {imu.pose()}).cast<double>().topLeftCorner<6, 6>();
  run_.Add(point, frontend_s_, total_s);
}

Result<PeerRun> System::Run() {
  run_ = {};
  run_.trajectory.has_velocity = run_.trajectory.has_bias = run_.trajectory.has_covariance = true;
  PeerSink sink;
  sink.imu = [this](const ImuSample& sample) {
    const double before = ProcessCpuSeconds();
    feed_measurement_imu({TimeOf(sample.stamp_ns), sample.gyro.cast<Real>(), sample.accel.cast<Real>()});
    imu_s_ += ProcessCpuSeconds() - before;
  };
  sink.time_offset_s = [this] { return TimeOffsetOf(*state); };
  sink.frame = [this](size_t frame) { return FeedFrame(frame); };
  ALIDADE_RETURN_IF_ERROR(FeedPeer(sequence_, sink));
  return run_;
}

}  // namespace alidade::open_vins
