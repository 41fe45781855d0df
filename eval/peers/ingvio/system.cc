#include "eval/peers/ingvio/system.h"

// First of all: it takes ROS from the stubs.
#include <GnssManager.h>
#include <GvioAligner.h>
#include <IngvioFilter.h>
#include <State.h>
#include <StateManager.h>
#include <camera_factory.h>
#include <mono_tracker.h>

#include <utility>
#include <vector>

#include "core/cpu_time.h"
#include "core/error_convention.h"
#include "eval/files/output_file.h"
#include "eval/peers/lens_check.h"

namespace alidade::ingvio {

/// What a node keeps to itself.
class Filter : public ::ingvio::IngvioFilter {
 public:
  using IngvioFilter::IngvioFilter;
  [[nodiscard]] const std::shared_ptr<::ingvio::State>& state() const { return _state; }
  [[nodiscard]] bool started() const { return _hasInitState; }

  [[nodiscard]] std::optional<Pose> T_EW() const {
    if (!_gvio_aligner->isAlign()) {
      return std::nullopt;
    }
    const Eigen::Isometry3d yaw = _state->_gnss.count(::ingvio::State::GNSSType::YOF) != 0
                                      ? ::ingvio::GnssManager::calcTw2enu(_state)
                                      : ::ingvio::GnssManager::calcTw2enu(_gvio_aligner->getYawOffset());
    const Eigen::Isometry3d T_EW = _gvio_aligner->getTenu2ecef() * yaw;
    return Pose{T_EW.linear(), T_EW.translation()};
  }
};

class Tracker : public ::feature_tracker::MonoTracker {
 public:
  using MonoTracker::MonoTracker;
};

namespace {

template <typename Message>
void Publish(const char* topic, std::shared_ptr<Message> message) {
  ros::Topics::Instance().Publish(topic, std::move(message));
}

geometry_msgs::Vector3 MessageOf(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Status CheckIngvioLens(const CameraModel& camera, const std::string& file) {
  const camera_model::CameraPtr lens =
      camera_model::CameraFactory::instance()->generateCameraFromYamlFile(file);
  return CheckLens(camera, [&](const Eigen::Vector2d& pixel) {
    Eigen::Vector3d ray;
    lens->liftProjective(pixel, ray);
    return ray;
  });
}

}  // namespace

System::System(const PeerSequence& sequence, const PeerGnss& gnss, bool uses_gnss)
    : sequence_(sequence), gnss_(gnss), uses_gnss_(uses_gnss), world_(sequence.dataset.rig.gnss.anchor_E) {
  run_.trajectory.has_velocity = run_.trajectory.has_bias = run_.trajectory.has_covariance = true;
}

System::~System() = default;

Result<std::unique_ptr<System>> System::Create(const PeerSequence& sequence, const PeerGnss& gnss,
                                               IngvioSettings settings, const std::string& folder,
                                               bool checks_lens) {
  std::unique_ptr<System> system(new System(sequence, gnss, settings.gnss));
  if (!gnss.epochs.empty()) {
    const PeerGnss::Epoch& first = gnss.epochs.front();
    const gnss_comm::GnssTimeMsg& time = first.message->meas.front().time;
    settings.local_less_gpst_s =
        system->TimeOf(first.stamp_ns) - gnss_comm::time2sec(gnss_comm::gpst2time(time.week, time.tow));
  }
  const std::string camera_file = folder + "/camera.yaml", file = folder + "/ingvio.yaml";
  const Result<std::string> camera = IngvioCameraFile(sequence.dataset.rig, settings);
  ALIDADE_RETURN_IF_ERROR(camera.status());
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(camera_file, *camera));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(file, IngvioFile(settings, camera_file)));
  if (const Status lens = CheckIngvioLens(sequence.dataset.rig.camera, camera_file);
      !lens.ok() && checks_lens) {
    return Status(lens.code(), lens.message() + "; --lens=own takes it as it is");
  }
  ros::NodeHandle node;
  ros::Parameters()["config_file"] = file;
  system->filter_ = std::make_unique<Filter>(node);
  system->filter_->initIO();
  if (!sequence.from_tracks) {
    cv::setNumThreads(1);
    ros::Parameters()["config_file"] = camera_file;
    system->tracker_ = std::make_unique<Tracker>(node);
    system->tracker_->init();
  }
  return system;
}

double System::TimeOf(TimeNs stamp_ns) const {
  return SecondsBetween(sequence_.dataset.imu.front().stamp_ns, stamp_ns);
}

void System::Work() {
  const double before = ProcessCpuSeconds();
  while (ros::Topics::Instance().DeliverOne()) {
  }
  times_.backend_ms += 1e3 * (ProcessCpuSeconds() - before);
}

void System::FeedImu(const ImuSample& sample) {
  const auto message = std::make_shared<sensor_msgs::Imu>();
  message->header.stamp = ros::Time(TimeOf(sample.stamp_ns));
  message->angular_velocity = MessageOf(sample.gyro);
  message->linear_acceleration = MessageOf(sample.accel);
  Publish("imu", message);
  Work();
}

void System::FeedNavigation() {
  for (const auto& message : gnss_.ephemerides) {
    Publish("ephem", message);
  }
  for (const auto& message : gnss_.glonass) {
    Publish("glo_ephem", message);
  }
  for (const auto& message : gnss_.ionosphere) {
    Publish("iono_params", message);
  }
  if (gnss_.ionosphere.empty()) {
    // Without any it uses no GNSS.
    const auto none = std::make_shared<gnss_comm::StampedFloat64Array>();
    none->data.assign(8, 0.0);
    Publish("iono_params", none);
  }
  Work();
}

void System::FeedEpoch(std::size_t epoch) {
  Publish("range_meas", gnss_.epochs[epoch].message);
  Work();
}

Status System::PublishFeatures(size_t frame, double time_s) {
  if (sequence_.from_tracks) {
    const auto message = std::make_shared<::feature_tracker::MonoFrame>();
    message->header.stamp = ros::Time(time_s);
    const CameraModel& camera = sequence_.dataset.rig.camera;
    for (const VinsFeature& f : given_.Take(camera, sequence_.dataset.frames[frame], time_s)) {
      ::feature_tracker::MonoMeas feature;
      feature.id = static_cast<std::uint64_t>(f.id);
      feature.u0 = f.plane.x();
      feature.v0 = f.plane.y();
      message->mono_features.push_back(feature);
    }
    Publish("mono_feature", message);
    return Status::Ok();
  }
  const Result<GreyImage> image =
      images_.ReadFor(sequence_.dataset.rig.camera, sequence_.dataset.images[frame]);
  ALIDADE_RETURN_IF_ERROR(image.status());
  const auto message = std::make_shared<sensor_msgs::Image>();
  message->header.stamp = ros::Time(time_s);
  message->height = static_cast<std::uint32_t>(image->height_px);
  message->width = message->step = static_cast<std::uint32_t>(image->width_px);
  message->encoding = "mono8";
  message->data.assign(image->pixels.begin(), image->pixels.end());
  Publish("image", message);
  const double before = ProcessCpuSeconds();
  ros::Topics::Instance().DeliverOne();
  times_.frontend_ms += 1e3 * (ProcessCpuSeconds() - before);
  return Status::Ok();
}

Status System::FeedFrame(size_t frame) {
  // Its filter has no time offset.
  const double time_s = TimeOf(sequence_.frames_ns[frame]) + sequence_.dataset.rig.camera_time_offset_s;
  ALIDADE_RETURN_IF_ERROR(PublishFeatures(frame, time_s));
  Work();
  Record(frame, time_s);
  return Status::Ok();
}

void System::Record(size_t frame, double time_s) {
  const std::shared_ptr<::ingvio::State>& state = filter_->state();
  if (!filter_->started() || state->_timestamp != time_s) {
    return;
  }
  TrajectoryPoint point;
  point.stamp_ns = sequence_.frames_ns[frame] + SecondsToNs(sequence_.dataset.rig.camera_time_offset_s);
  point.nav.R_WB = state->_extended_pose->valueLinearAsQuat().normalized().toRotationMatrix();
  point.nav.p_WB = state->_extended_pose->valueTrans1();
  point.nav.v_WB = state->_extended_pose->valueTrans2();
  point.bias.gyro = state->_bg->value();
  point.bias.accel = state->_ba->value();
  if (!(point.nav.R_WB.allFinite() && point.nav.p_WB.allFinite() && point.nav.v_WB.allFinite())) {
    return;
  }
  // Its error is Exp(xi) from the left.
  const Matrix9d chart = ChartJacobian(ErrorConvention::kRightInvariant, point.nav);
  const Matrix9d covariance =
      chart * ::ingvio::StateManager::getMarginalCov(state, {state->_extended_pose}) * chart.transpose();
  point.covariance = covariance.topLeftCorner<6, 6>();
  world_.Add(point, uses_gnss_ ? filter_->T_EW() : std::nullopt);
  run_.times.push_back(times_);
  times_ = {};
}

Result<PeerRun> System::Run() {
  std::vector<TimeNs> epochs_ns;
  if (uses_gnss_) {
    FeedNavigation();
    for (const PeerGnss::Epoch& epoch : gnss_.epochs) {
      epochs_ns.push_back(epoch.stamp_ns);
    }
  }
  PeerSink sink;
  sink.imu = [this](const ImuSample& sample) { FeedImu(sample); };
  sink.time_offset_s = [this] { return sequence_.dataset.rig.camera_time_offset_s; };
  sink.frame = [this](size_t frame) { return FeedFrame(frame); };
  sink.epoch = [this](std::size_t epoch) { FeedEpoch(epoch); };
  ALIDADE_RETURN_IF_ERROR(FeedPeer(sequence_, sink, epochs_ns));
  run_.trajectory.points = world_.points();
  return run_;
}

}  // namespace alidade::ingvio
