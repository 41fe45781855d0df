#include "eval/peers/msceqf/system.h"

#include <atomic>

#include "core/cpu_time.h"

namespace {

/// CPU time of the tracker in the frame being fed [s]. The tracker runs on a thread of its own.
std::atomic<double> tracker_s = 0;

}  // namespace

// In place of TrackManager::processCamera (linked with --wrap): the same, timed.
extern "C" void __real__ZN6msceqf12TrackManager13processCameraERNS_6CameraE(msceqf::TrackManager*,
                                                                            msceqf::Camera&);
extern "C" void __wrap__ZN6msceqf12TrackManager13processCameraERNS_6CameraE(msceqf::TrackManager* manager,
                                                                            msceqf::Camera& camera) {
  const double before = alidade::ThreadCpuSeconds();
  __real__ZN6msceqf12TrackManager13processCameraERNS_6CameraE(manager, camera);
  tracker_s = alidade::ThreadCpuSeconds() - before;
}

namespace alidade::msceqf_driver {

System::System(const std::string& file, const PeerSequence& sequence) : sequence_(sequence), filter_(file) {}

double System::TimeOf(TimeNs stamp_ns) const {
  return SecondsBetween(sequence_.dataset.imu.front().stamp_ns, stamp_ns);
}

Status System::FeedFrame(size_t frame) {
  const CameraModel& camera = sequence_.dataset.rig.camera;
  Result<GreyImage> image = images_.ReadFor(camera, sequence_.dataset.images[frame]);
  ALIDADE_RETURN_IF_ERROR(image.status());
  msceqf::Camera message;
  message.timestamp_ = TimeOf(sequence_.frames_ns[frame]);
  message.image_ = cv::Mat(image->height_px, image->width_px, CV_8UC1, image->pixels.data()).clone();
  tracker_s = 0;
  const double before = ProcessCpuSeconds();
  filter_.processMeasurement(message);
  Record(frame, ProcessCpuSeconds() - before + imu_s_);
  imu_s_ = 0;
  return Status::Ok();
}

void System::Record(size_t frame, double total_s) {
  if (!filter_.isInit()) {
    return;
  }
  const msceqf::SystemState& state = filter_.stateEstimate();
  const msceqf::SE23& T = state.T();
  TrajectoryPoint point;
  point.stamp_ns = sequence_.frames_ns[frame] + SecondsToNs(sequence_.dataset.rig.camera_time_offset_s);
  point.nav.R_WB = T.R();
  point.nav.p_WB = T.p();
  point.nav.v_WB = T.v();
  point.bias.gyro = state.b().head<3>();
  point.bias.accel = state.b().tail<3>();
  // The true extended pose is T0 Exp(e) D with T0 D the estimate: T Exp(Ad(D^-1) e) with e = (rotation,
  // velocity, position). Its position part is in the body frame, that of the canonical chart in the world.
  const msceqf::SE23 D = filter_.stateOrigin().T().inv() * T;
  const Eigen::Matrix<double, 9, 9> to_body = D.invAdjoint();
  Eigen::Matrix<double, 6, 9> J;
  J << to_body.topRows<3>(), T.R() * to_body.bottomRows<3>();
  point.covariance = J * filter_.covariance().topLeftCorner<9, 9>() * J.transpose();
  run_.Add(point, tracker_s, total_s);
}

Result<PeerRun> System::Run() {
  run_ = {};
  run_.trajectory.has_velocity = run_.trajectory.has_bias = run_.trajectory.has_covariance = true;
  PeerSink sink;
  sink.imu = [this](const ImuSample& sample) {
    const double before = ProcessCpuSeconds();
    msceqf::Imu message;
    message.timestamp_ = TimeOf(sample.stamp_ns);
    message.ang_ = sample.gyro;
    message.acc_ = sample.accel;
    filter_.processMeasurement(message);
    imu_s_ += ProcessCpuSeconds() - before;
  };
  sink.time_offset_s = [this] { return sequence_.dataset.rig.camera_time_offset_s; };
  sink.frame = [this](size_t frame) { return FeedFrame(frame); };
  ALIDADE_RETURN_IF_ERROR(FeedPeer(sequence_, sink));
  return run_;
}

}  // namespace alidade::msceqf_driver
