#include "eval/bag/bag_export.h"

#include <algorithm>

#include "core/format.h"
#include "eval/bag/bag_fixes.h"
#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_fix.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/rosbag/rosbag_writer.h"
#include "frontend/tracking/image_reader.h"
#include "gnss/base/anchor_llh.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

/// A message to be made when its turn comes.
struct Pending {
  TimeNs stamp_ns = 0;
  std::uint32_t topic = 0;
  std::function<Result<std::string>()> encode;
};

/// Lists all messages of a sequence.
class Schedule {
 public:
  Schedule(const Dataset& dataset, const BagTopics& topics, RosbagWriter* bag)
      : dataset_(dataset), topics_(topics), bag_(bag) {}

  std::vector<Pending> Make() {
    AddMotion();
    AddCamera();
    if (dataset_.gnss != nullptr) {
      AddObservations(*dataset_.gnss);
      AddNavigation(dataset_.gnss->catalog->navigation());
    }
    AddFixes();
    AddSheets();
    // Stable: messages of one stamp keep the order in which they were listed.
    std::stable_sort(pending_.begin(), pending_.end(),
                     [](const Pending& a, const Pending& b) { return a.stamp_ns < b.stamp_ns; });
    return std::move(pending_);
  }

 private:
  void Add(TimeNs stamp_ns, std::uint32_t topic, std::function<Result<std::string>()> encode) {
    pending_.push_back({stamp_ns, topic, std::move(encode)});
  }

  void AddMotion() {
    const std::uint32_t imu = bag_->AddTopic(topics_.imu, "sensor_msgs/Imu");
    for (const ImuSample& sample : dataset_.imu) {
      Add(sample.stamp_ns, imu, [&sample] { return EncodeImu(sample); });
    }
    if (!dataset_.truth || !dataset_.truth->has_orientation) {
      return;
    }
    const std::uint32_t truth = bag_->AddTopic(topics_.truth, "alidade/State");
    for (const TrajectoryPoint& point : dataset_.truth->points) {
      Add(point.stamp_ns, truth,
          [&point, has_velocity = dataset_.truth->has_velocity] { return EncodeState(point, has_velocity); });
    }
  }

  void AddCamera() {
    if (!dataset_.images.empty()) {
      const std::uint32_t topic = bag_->AddTopic(topics_.camera, "sensor_msgs/Image");
      for (const ImageEntry& image : dataset_.images) {
        Add(image.stamp_ns, topic, [&image] { return ReadImageMessage(image); });
      }
    }
    std::vector<TrackFrame> frames = dataset_.tracks;
    if (frames.empty() && dataset_.images.empty()) {
      for (const TimeNs stamp_ns : dataset_.camera_stamps) {
        frames.push_back({stamp_ns, {}, 0});
      }
    }
    AddTracks(topics_.tracks, std::move(frames));
    for (std::size_t k = 0; k < dataset_.extra_cameras.size(); ++k) {
      AddTracks("/cam" + std::to_string(k + 1) + "/tracks", dataset_.extra_cameras[k].frames);
    }
  }

  static Result<std::string> ReadImageMessage(const ImageEntry& image) {
    const Result<GreyImage> grey = ReadGreyImage(image.path);
    ALIDADE_RETURN_IF_ERROR(grey.status());
    return EncodeImage(image.stamp_ns, grey->width_px, grey->height_px,
                       {reinterpret_cast<const char*>(grey->pixels.data()), grey->pixels.size()});
  }

  void AddTracks(const std::string& name, std::vector<TrackFrame> frames) {
    if (frames.empty()) {
      return;
    }
    const std::uint32_t topic = bag_->AddTopic(name, "alidade/Tracks");
    for (TrackFrame& frame : frames) {
      const TimeNs stamp_ns = frame.stamp_ns;
      Add(stamp_ns, topic, [frame = std::move(frame)] { return EncodeTracks(frame); });
    }
  }

  void AddObservations(const GnssLog& gnss) {
    const std::uint32_t range = bag_->AddTopic(topics_.range, "gnss_comm/GnssMeasMsg");
    const std::uint32_t pulse = bag_->AddTopic(topics_.time_pulse, "gnss_comm/GnssTimePulseInfoMsg");
    const std::uint32_t trigger = bag_->AddTopic(topics_.trigger, "gvins/LocalSensorExternalTrigger");
    const TimeNs offset_ns = SecondsToNs(dataset_.rig.gnss.time_offset_s);
    TimeNs next_pulse_ns = INT64_MIN;
    for (const ObservationEpoch& epoch : gnss.epochs) {
      const TimeNs stamp_ns = epoch.stamp_ns + offset_ns;
      Add(stamp_ns, range, [&epoch, &gnss] { return EncodeMeasurements(epoch, gnss.glonass_channels); });
      if (epoch.stamp_ns >= next_pulse_ns) {
        const TimeNs pulse_ns = (epoch.stamp_ns / kSecondNs + 1) * kSecondNs;
        next_pulse_ns = pulse_ns;
        Add(stamp_ns, pulse, [pulse_ns] { return EncodeTimePulse(pulse_ns); });
        const TimeNs local_ns = pulse_ns + offset_ns;
        Add(local_ns, trigger, [local_ns] { return EncodeTrigger(local_ns); });
      }
    }
  }

  void AddNavigation(const NavigationData& navigation) {
    const std::uint32_t kepler = bag_->AddTopic(topics_.ephemeris, "gnss_comm/GnssEphemMsg");
    const std::uint32_t glonass = bag_->AddTopic(topics_.glonass_ephemeris, "gnss_comm/GnssGloEphemMsg");
    const TimeNs start_ns = Start();
    const auto add = [&](std::uint32_t topic, const auto& ephemeris) {
      if (std::optional<std::string> message = EncodeEphemeris(ephemeris)) {
        Add(start_ns, topic, [message = *message] { return message; });
      }
    };
    for (const auto& [id, list] : navigation.kepler) {
      for (const KeplerEphemeris& ephemeris : list) {
        add(kepler, ephemeris);
      }
    }
    for (const auto& [number, list] : navigation.glonass) {
      for (const GlonassEphemeris& ephemeris : list) {
        add(glonass, ephemeris);
      }
    }
    for (const auto& [name, parameters] :
         {std::pair(topics_.ionosphere, navigation.gps_ionosphere),
          std::pair(topics_.beidou_ionosphere, navigation.beidou_ionosphere)}) {
      if (parameters) {
        const std::uint32_t topic = bag_->AddTopic(name, "gnss_comm/StampedFloat64Array");
        Add(start_ns, topic,
            [start_ns, parameters = *parameters] { return EncodeIonosphere(start_ns, parameters); });
      }
    }
  }

  void AddFixes() {
    std::vector<std::uint32_t> topics;
    topics.reserve(dataset_.rig.fixes.size());
    for (std::size_t k = 0; k < dataset_.rig.fixes.size(); ++k) {
      topics.push_back(dataset_.rig.fixes[k].anchor_llh_deg
                           ? bag_->AddTopic(NavSatFixTopic(topics_, k), "sensor_msgs/NavSatFix")
                           : bag_->AddTopic(PositionTopic(k), "alidade/Position"));
    }
    for (const PositionFix& fix : dataset_.fixes) {
      const auto k = static_cast<std::size_t>(fix.sensor);
      const FixSensor& sensor = dataset_.rig.fixes[k];
      Add(fix.stamp_ns + SecondsToNs(sensor.time_offset_s), topics[k], [&fix, &sensor] {
        return sensor.anchor_llh_deg ? EncodeNavSatFix(OnEarth(fix, *sensor.anchor_llh_deg))
                                     : EncodePosition(fix);
      });
    }
  }

  static NavSatFix OnEarth(const PositionFix& fix, const Eigen::Vector3d& anchor_llh_deg) {
    const EnuFrame enu = EnuFrameAtLlh(anchor_llh_deg);
    const Eigen::Vector3d position_E = enu.ToEcef(fix.p_A);
    const Eigen::Matrix3d turn = EnuFrame::At(position_E).R_EN.transpose() * enu.R_EN;
    return {fix.stamp_ns, LlhDegOf(position_E), turn * fix.covariance * turn.transpose()};
  }

  void AddSheets() {
    AddSheet("imu0", ImuSensorYaml(dataset_.rig.imu_noise, dataset_.imu_rate_hz));
    if (!dataset_.images.empty() || !dataset_.tracks.empty() || !dataset_.camera_stamps.empty()) {
      AddSheet("cam0", CameraSensorYaml(dataset_.rig, dataset_.camera_rate_hz));
    }
    for (std::size_t k = 0; k < dataset_.extra_cameras.size(); ++k) {
      AddSheet("cam" + std::to_string(k + 1), ExtraCameraYaml(dataset_, k));
    }
    for (std::size_t k = 0; k < dataset_.rig.fixes.size(); ++k) {
      AddSheet("fix" + std::to_string(k), FixSensorYaml(dataset_.rig.fixes[k]));
    }
    if (dataset_.gnss != nullptr) {
      AddSheet("gnss0", GnssSensorYaml(dataset_.rig.gnss, dataset_.gnss->approximate_position_E));
    }
  }

  void AddSheet(const std::string& sensor, const std::string& text) {
    const std::uint32_t topic = bag_->AddTopic(SheetTopic(sensor), "std_msgs/String", true);
    Add(Start(), topic, [text] { return EncodeText(text); });
  }

  /// The first stamp of all, at which what has no stamp is said.
  [[nodiscard]] TimeNs Start() const {
    TimeNs start_ns = INT64_MAX;
    for (const Pending& pending : pending_) {
      start_ns = std::min(start_ns, pending.stamp_ns);
    }
    return start_ns;
  }

  const Dataset& dataset_;
  const BagTopics& topics_;
  RosbagWriter* bag_;
  std::vector<Pending> pending_;
};

}  // namespace

Status WriteBag(const Dataset& dataset, const BagExportOptions& options, const std::string& path) {
  Result<RosbagWriter> bag = RosbagWriter::Create(path, options.compression);
  ALIDADE_RETURN_IF_ERROR(bag.status());
  const std::vector<Pending> schedule = Schedule(dataset, options.topics, &*bag).Make();
  for (std::size_t i = 0; i < schedule.size(); ++i) {
    if (options.stop != nullptr && options.stop->load()) {
      return Status::Diverged("stopped");
    }
    const Result<std::string> message = schedule[i].encode();
    ALIDADE_RETURN_IF_ERROR(message.status());
    ALIDADE_RETURN_IF_ERROR(bag->Write(schedule[i].topic, schedule[i].stamp_ns, *message));
    if (options.progress) {
      options.progress(i + 1, schedule.size());
    }
  }
  return bag->Close();
}

}  // namespace alidade
