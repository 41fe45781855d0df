#include "eval/bag/bag_camera.h"

#include <string>
#include <utility>

#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/sensor_table.h"
#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {
namespace {

constexpr std::size_t kMaxCameras = 16;

std::string ExtraTracksTopic(std::size_t k) {
  return "/cam" + std::to_string(k) + "/tracks";
}

void KeepImage(TimeNs stamp_ns, const BagMessage& message, bool compressed, BagContext* bag) {
  bag->dataset.images.push_back({stamp_ns, bag->path, ImageEntry::InBag{message.place, compressed}});
}

Result<std::string> ReadImageMessage(const ImageEntry& image) {
  const Result<GreyImage> grey = ReadGreyImage(image.path);
  ALIDADE_RETURN_IF_ERROR(grey.status());
  return EncodeImage(image.stamp_ns, grey->width_px, grey->height_px,
                     {reinterpret_cast<const char*>(grey->pixels.data()), grey->pixels.size()});
}

void ScheduleTracks(const std::string& name, std::vector<TrackFrame> frames, BagSchedule* schedule) {
  if (frames.empty()) {
    return;
  }
  const std::uint32_t topic = schedule->AddTopic(name, "alidade/Tracks");
  for (TrackFrame& frame : frames) {
    const TimeNs stamp_ns = frame.stamp_ns;
    schedule->Add(stamp_ns, topic, [frame = std::move(frame)] { return EncodeTracks(frame); });
  }
}

}  // namespace

std::vector<BagTopic> CameraTopics() {
  return {{"cam0",
           "/cam0/image_raw",
           {"sensor_msgs/Image", "sensor_msgs/CompressedImage"},
           BagTopic::Search::kByType},
          {"tracks", "/cam0/tracks", {"alidade/Tracks"}}};
}

Result<bool> BagCamera::Take(const BagMessage& message, BagContext* bag) {
  const std::string& topic = message.connection->topic;
  const std::string& type = message.connection->type;
  if (type == "alidade/Tracks" && topic == bag->topics["tracks"]) {
    KeepDecoded(DecodeTracks(message.data), topic, &bag->dataset.frames, &bag->remarks);
    return true;
  }
  const bool raw = type == "sensor_msgs/Image";
  if ((!raw && type != "sensor_msgs/CompressedImage") || topic != bag->topics["cam0"]) {
    return false;
  }
  ALIDADE_RETURN_IF_ERROR(raw ? TakeImage(message, bag) : TakeCompressed(message, bag));
  return true;
}

Status BagCamera::TakeImage(const BagMessage& message, BagContext* bag) {
  const std::optional<RawImage> image = DecodeImage(message.data);
  if (image && !bag->options.take_image) {
    KeepImage(image->stamp_ns, message, false, bag);
    return Status::Ok();
  }
  has_images_ = true;
  std::optional<GreyImage> grey = image ? GreyOf(*image) : std::nullopt;
  if (!grey) {
    bag->remarks.AddSkipped(message.connection->topic,
                            image ? "encoding '" + image->encoding + "', expected mono, rgb or bgr"
                                  : std::string("does not decode"));
    return Status::Ok();
  }
  return bag->options.take_image({image->stamp_ns, *std::move(grey), {}, ""});
}

Status BagCamera::TakeCompressed(const BagMessage& message, BagContext* bag) {
  const std::optional<CompressedImage> image = DecodeCompressedImage(message.data);
  if (!image) {
    bag->remarks.AddSkipped(message.connection->topic, "does not decode");
    return Status::Ok();
  }
  if (!bag->options.take_image) {
    KeepImage(image->stamp_ns, message, true, bag);
    return Status::Ok();
  }
  has_images_ = true;
  const bool png = image->file.starts_with("\x89PNG");
  return bag->options.take_image({image->stamp_ns, {}, image->file, png ? "png" : "jpg"});
}

Status BagCamera::Assemble(BagContext* bag) {
  Dataset& dataset = bag->dataset;
  bag->remarks.AddDropped(bag->topics["cam0"], SortByStamp(&dataset.images));
  bag->remarks.AddDropped(bag->topics["tracks"], SortByStamp(&dataset.frames));
  if (!has_images_ && dataset.images.empty() && dataset.frames.empty()) {
    return Status::Ok();
  }
  const Result<CameraSensor> sensor = bag->sheets.Camera("cam0", bag->options.camera);
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  dataset.rig.camera = sensor->camera;
  dataset.rig.T_BC = sensor->T_BC;
  dataset.rig.camera_time_offset_s = sensor->time_offset_s;
  dataset.rig.line_delay_s = sensor->line_delay_s;
  dataset.camera_rate_hz = sensor->rate_hz.value_or(0);
  const std::vector<TrackFrame>& tracks = dataset.frames;
  const std::vector<ImageEntry>& images = dataset.images;
  if (!sensor->rate_hz && !tracks.empty()) {
    dataset.camera_rate_hz = MeasuredRate(tracks.front().stamp_ns, tracks.back().stamp_ns, tracks.size());
  } else if (!sensor->rate_hz && !images.empty()) {
    dataset.camera_rate_hz = MeasuredRate(images.front().stamp_ns, images.back().stamp_ns, images.size());
  }
  return Status::Ok();
}

Result<bool> BagExtraCameras::Take(const BagMessage& message, BagContext* bag) {
  const std::string& topic = message.connection->topic;
  if (message.connection->type != "alidade/Tracks") {
    return false;
  }
  for (std::size_t k = 1; k < kMaxCameras; ++k) {
    if (topic == ExtraTracksTopic(k)) {
      KeepDecoded(DecodeTracks(message.data), topic, &frames_[k], &bag->remarks);
    }
  }
  return true;
}

Status BagExtraCameras::Assemble(BagContext* bag) {
  for (auto& [k, frames] : frames_) {
    const std::string name = "cam" + std::to_string(k);
    if (bag->sheets.Text(name) == nullptr || frames.empty()) {
      bag->remarks.Add(ExtraTracksTopic(k) + ": no calibration for this camera, skipped");
      continue;
    }
    const Result<CameraSensor> sensor = bag->sheets.Camera(name, std::nullopt);
    ALIDADE_RETURN_IF_ERROR(sensor.status());
    SortByStamp(&frames);
    bag->dataset.extra_cameras.push_back(
        {sensor->camera, sensor->T_BC, sensor->time_offset_s, std::move(frames)});
  }
  return Status::Ok();
}

void ScheduleCameras(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  if (!dataset.images.empty()) {
    const std::uint32_t topic = schedule->AddTopic(topics["cam0"], "sensor_msgs/Image");
    for (const ImageEntry& image : dataset.images) {
      schedule->Add(image.stamp_ns, topic, [&image] { return ReadImageMessage(image); });
    }
  }
  std::vector<TrackFrame> frames = dataset.frames;
  if (frames.empty() && dataset.images.empty()) {
    for (const TimeNs stamp_ns : dataset.camera_stamps) {
      frames.push_back({stamp_ns, {}, 0});
    }
  }
  ScheduleTracks(topics["tracks"], std::move(frames), schedule);
  for (std::size_t k = 0; k < dataset.extra_cameras.size(); ++k) {
    ScheduleTracks(ExtraTracksTopic(k + 1), dataset.extra_cameras[k].frames, schedule);
  }
}

void ScheduleCameraSheets(const Dataset& dataset, BagSchedule* schedule) {
  if (!dataset.images.empty() || !dataset.frames.empty() || !dataset.camera_stamps.empty()) {
    schedule->AddSheet("cam0", CameraSensorYaml(dataset.rig, dataset.camera_rate_hz));
  }
  for (std::size_t k = 0; k < dataset.extra_cameras.size(); ++k) {
    schedule->AddSheet("cam" + std::to_string(k + 1), ExtraCameraYaml(dataset, k));
  }
}

}  // namespace alidade
