#include "eval/bag/bag_import.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "eval/bag/bag_fixes.h"
#include "eval/bag/bag_gnss.h"
#include "eval/bag/bag_sheets.h"
#include "eval/dataset/calibration_import.h"
#include "eval/dataset/sensor_table.h"
#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {
namespace {

constexpr std::size_t kMaxCameras = 16;

/// Sorts by stamp and drops all but the first of equal stamps; how many were dropped.
template <typename Entry>
std::size_t SortByStamp(std::vector<Entry>* entries) {
  const auto before = [](const Entry& a, const Entry& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same = [](const Entry& a, const Entry& b) { return a.stamp_ns == b.stamp_ns; };
  std::stable_sort(entries->begin(), entries->end(), before);
  const std::size_t count = entries->size();
  entries->erase(std::unique(entries->begin(), entries->end(), same), entries->end());
  return count - entries->size();
}

/// One bag on its way to a dataset.
class Importer {
 public:
  Importer(const std::string& path, const BagImportOptions& options)
      : path_(path), options_(options), topics_(options.topics), sheets_(path) {}

  Result<BagImport> Execute() {
    Result<RosbagReader> bag = RosbagReader::Open(path_);
    ALIDADE_RETURN_IF_ERROR(bag.status());
    ALIDADE_RETURN_IF_ERROR(ListTopics(&*bag));
    ALIDADE_RETURN_IF_ERROR(topics_.Resolve(path_, found_));
    Result<BagScan> scan = bag->Scan([this](const BagMessage& message) { return Take(message); });
    ALIDADE_RETURN_IF_ERROR(scan.status());
    import_.scan = *scan;
    DescribeScan();
    ALIDADE_RETURN_IF_ERROR(Assemble());
    return std::move(import_);
  }

 private:
  void Remark(const std::string& text) { import_.remarks.push_back(path_ + ": " + text); }

  Status ListTopics(RosbagReader* bag) {
    const Result<BagScan> scan = bag->Scan([this](const BagMessage& message) {
      found_[message.connection->topic] = message.connection->type;
      return Stopped();
    });
    ALIDADE_RETURN_IF_ERROR(scan.status());
    total_ = scan->messages;
    return scan->messages > 0 ? Status::Ok() : Status::Input(path_ + ": holds no complete message");
  }

  [[nodiscard]] Status Stopped() const {
    return options_.stop != nullptr && options_.stop->load() ? Status::Diverged("stopped") : Status::Ok();
  }

  Status Take(const BagMessage& message) {
    ALIDADE_RETURN_IF_ERROR(Stopped());
    if (options_.progress) {
      options_.progress(++done_, total_);
    }
    const std::string& topic = message.connection->topic;
    const std::string& type = message.connection->type;
    if (type == "sensor_msgs/Imu" && topic == topics_.imu) {
      Keep(DecodeImu(message.data), topic, &import_.dataset.imu);
    } else if (type == "sensor_msgs/Image" && topic == topics_.camera) {
      return TakeImage(message);
    } else if (type == "sensor_msgs/CompressedImage" && topic == topics_.camera) {
      return TakeCompressed(message);
    } else if (type == "alidade/Tracks") {
      TakeTracks(topic, message.data);
    } else if (type == "alidade/State" && topic == topics_.truth) {
      TakeState(message.data);
    } else if (type == "std_msgs/String" && topic.ends_with("/sensor_yaml")) {
      if (std::optional<std::string> text = DecodeText(message.data)) {
        sheets_.Take(topic, *std::move(text));
      }
    } else if (const Result<bool> fix = fixes_.Take(topics_, message); !fix.ok()) {
      Damage(topic, fix.message());
    } else if (const Status status = *fix ? Status::Ok() : gnss_.Take(topics_, message); !status.ok()) {
      Damage(topic, status.message());
    }
    return Status::Ok();
  }

  template <typename Entry>
  void Keep(std::optional<Entry> entry, const std::string& topic, std::vector<Entry>* entries) {
    if (entry) {
      entries->push_back(std::move(*entry));
    } else {
      Damage(topic, "does not decode");
    }
  }

  void Damage(const std::string& topic, const std::string& what) {
    if (damaged_[topic]++ == 0) {
      Remark(topic + ": a message was skipped: " + what);
    }
  }

  Status KeepImage(TimeNs stamp_ns, const BagMessage& message, bool compressed) {
    import_.dataset.images.push_back({stamp_ns, path_, ImageEntry::InBag{message.place, compressed}});
    return Status::Ok();
  }

  Status TakeImage(const BagMessage& message) {
    const std::optional<RawImage> image = DecodeImage(message.data);
    if (image && !options_.take_image) {
      return KeepImage(image->stamp_ns, message, false);
    }
    has_images_ = true;
    std::optional<GreyImage> grey = image ? GreyOf(*image) : std::nullopt;
    if (!grey) {
      Damage(topics_.camera, image ? "encoding '" + image->encoding + "', expected mono, rgb or bgr"
                                   : std::string("does not decode"));
      return Status::Ok();
    }
    return options_.take_image({image->stamp_ns, *std::move(grey), {}, ""});
  }

  Status TakeCompressed(const BagMessage& message) {
    const std::optional<CompressedImage> image = DecodeCompressedImage(message.data);
    if (!image) {
      Damage(topics_.camera, "does not decode");
      return Status::Ok();
    }
    if (!options_.take_image) {
      return KeepImage(image->stamp_ns, message, true);
    }
    has_images_ = true;
    const bool png = image->file.starts_with("\x89PNG");
    return options_.take_image({image->stamp_ns, {}, image->file, png ? "png" : "jpg"});
  }

  void TakeTracks(const std::string& topic, std::string_view data) {
    if (topic == topics_.tracks) {
      Keep(DecodeTracks(data), topic, &import_.dataset.tracks);
      return;
    }
    for (std::size_t k = 1; k < kMaxCameras; ++k) {
      if (topic == "/cam" + std::to_string(k) + "/tracks") {
        Keep(DecodeTracks(data), topic, &extra_[k]);
      }
    }
  }

  void TakeState(std::string_view data) {
    const std::optional<DecodedState> state = DecodeState(data);
    if (!state) {
      return Damage(topics_.truth, "does not decode");
    }
    if (!import_.dataset.truth) {
      import_.dataset.truth.emplace();
      import_.dataset.truth->has_velocity = import_.dataset.truth->has_bias = state->has_velocity;
    }
    import_.dataset.truth->points.push_back(state->point);
  }

  void DescribeScan() {
    const BagScan& scan = import_.scan;
    if (scan.truncated) {
      Remark("ends inside a record; the complete records were read");
    } else if (!scan.indexed) {
      Remark("was never closed and has no index; it was read from front to back");
    }
    if (scan.damaged > 0) {
      Remark(std::to_string(scan.damaged) + " damaged parts skipped, the first: " + scan.first_damage);
    }
    for (const auto& [topic, count] : damaged_) {
      if (count > 1) {
        Remark(topic + ": " + std::to_string(count) + " messages skipped in total");
      }
    }
  }

  Status Assemble() {
    Dataset& dataset = import_.dataset;
    dataset.path = path_;
    dataset.name = std::filesystem::path(path_).stem().string();
    DescribeDropped(topics_.imu, SortByStamp(&dataset.imu));
    if (dataset.imu.size() < 2) {
      return Status::Input(path_ + ": " + topics_.imu + ": " + std::to_string(dataset.imu.size()) +
                           " samples, expected at least two");
    }
    DescribeDropped(topics_.camera, SortByStamp(&dataset.images));
    DescribeDropped(topics_.tracks, SortByStamp(&dataset.tracks));
    if (dataset.truth) {
      DescribeDropped(topics_.truth, SortByStamp(&dataset.truth->points));
    }
    ALIDADE_RETURN_IF_ERROR(AssembleImu());
    ALIDADE_RETURN_IF_ERROR(AssembleCamera());
    ALIDADE_RETURN_IF_ERROR(AssembleExtraCameras());
    ALIDADE_RETURN_IF_ERROR(fixes_.Assemble(path_, sheets_, &dataset, &import_.remarks));
    const std::string* sheet = sheets_.Text("gnss0");
    return gnss_.Assemble(path_, sheet == nullptr ? std::string() : *sheet, &dataset, &import_.remarks);
  }

  void DescribeDropped(const std::string& topic, std::size_t dropped) {
    if (dropped > 0) {
      Remark(topic + ": " + std::to_string(dropped) + " messages with a duplicate stamp, skipped");
    }
  }

  Status AssembleImu() {
    Dataset& dataset = import_.dataset;
    const Result<ImuSensor> sensor = sheets_.Imu(options_.imu);
    ALIDADE_RETURN_IF_ERROR(sensor.status());
    const double measured_hz =
        MeasuredRate(dataset.imu.front().stamp_ns, dataset.imu.back().stamp_ns, dataset.imu.size());
    const bool per_sample = options_.imu && options_.imu_is_per_sample;
    dataset.rig.imu_noise = per_sample ? DensitiesOf(sensor->noise, measured_hz) : sensor->noise;
    dataset.imu_rate_hz = sensor->rate_hz.value_or(measured_hz);
    return Status::Ok();
  }

  Status AssembleCamera() {
    Dataset& dataset = import_.dataset;
    if (!has_images_ && dataset.images.empty() && dataset.tracks.empty()) {
      return Status::Ok();
    }
    const Result<CameraSensor> sensor = sheets_.Camera("cam0", options_.camera);
    ALIDADE_RETURN_IF_ERROR(sensor.status());
    dataset.rig.camera = sensor->camera;
    dataset.rig.T_BC = sensor->T_BC;
    dataset.rig.camera_time_offset_s = sensor->time_offset_s;
    dataset.camera_rate_hz = sensor->rate_hz.value_or(0);
    const std::vector<TrackFrame>& tracks = dataset.tracks;
    const std::vector<ImageEntry>& images = dataset.images;
    if (!sensor->rate_hz && !tracks.empty()) {
      dataset.camera_rate_hz = MeasuredRate(tracks.front().stamp_ns, tracks.back().stamp_ns, tracks.size());
    } else if (!sensor->rate_hz && !images.empty()) {
      dataset.camera_rate_hz = MeasuredRate(images.front().stamp_ns, images.back().stamp_ns, images.size());
    }
    return Status::Ok();
  }

  Status AssembleExtraCameras() {
    for (auto& [k, frames] : extra_) {
      const std::string name = "cam" + std::to_string(k);
      if (sheets_.Text(name) == nullptr || frames.empty()) {
        Remark("/" + name + "/tracks: no calibration for this camera, skipped");
        continue;
      }
      const Result<CameraSensor> sensor = sheets_.Camera(name, std::nullopt);
      ALIDADE_RETURN_IF_ERROR(sensor.status());
      SortByStamp(&frames);
      import_.dataset.extra_cameras.push_back(
          {sensor->camera, sensor->T_BC, sensor->time_offset_s, std::move(frames)});
    }
    return Status::Ok();
  }

  const std::string& path_;
  const BagImportOptions& options_;
  BagTopics topics_;
  std::map<std::string, std::string> found_;  ///< topic -> type
  BagSheets sheets_;
  std::map<std::string, std::int64_t> damaged_;
  std::map<std::size_t, std::vector<TrackFrame>> extra_;
  BagGnss gnss_;
  BagFixes fixes_;
  bool has_images_ = false;  ///< that were handed over
  std::int64_t done_ = 0;
  std::int64_t total_ = 0;
  BagImport import_;
};

}  // namespace

Result<BagImport> ReadBag(const std::string& path, const BagImportOptions& options) {
  return Importer(path, options).Execute();
}

bool IsBag(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && path.ends_with(".bag");
}

}  // namespace alidade
