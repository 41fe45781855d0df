#include "eval/bag/dataset_images.h"

#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {

Result<GreyImage> DatasetImages::Read(const ImageEntry& image) {
  if (!image.in_bag) {
    return ReadGreyImage(image.path);
  }
  if (!bag_ || bag_->path() != image.path) {
    Result<RosbagReader> bag = RosbagReader::Open(image.path);
    ALIDADE_RETURN_IF_ERROR(bag.status());
    bag_ = std::move(*bag);
  }
  const Result<std::string_view> message = bag_->ReadAgain(image.in_bag->place);
  ALIDADE_RETURN_IF_ERROR(message.status());
  const std::string name = image.path + ": image of " + std::to_string(image.stamp_ns) + " ns";
  if (image.in_bag->compressed) {
    const std::optional<CompressedImage> compressed = DecodeCompressedImage(*message);
    const std::string_view file = compressed ? compressed->file : std::string_view();
    return DecodeGreyImage({reinterpret_cast<const unsigned char*>(file.data()), file.size()}, name);
  }
  const std::optional<RawImage> raw = DecodeImage(*message);
  std::optional<GreyImage> grey = raw ? GreyOf(*raw) : std::nullopt;
  if (!grey) {
    return Status::Input(name + ": found encoding '" + (raw ? raw->encoding : std::string()) +
                         "', expected mono, rgb or bgr");
  }
  return *std::move(grey);
}

Result<GreyImage> DatasetImages::ReadFor(const CameraModel& camera, const ImageEntry& image) {
  Result<GreyImage> grey = Read(image);
  if (grey.ok() && (grey->width_px != camera.width_px() || grey->height_px != camera.height_px())) {
    return Status::Input(image.path + ": image at " + std::to_string(image.stamp_ns) + " ns of " +
                         std::to_string(grey->width_px) + " x " + std::to_string(grey->height_px) +
                         " px, expected the resolution " + std::to_string(camera.width_px()) + " x " +
                         std::to_string(camera.height_px()) + " of sensor.yaml");
  }
  return grey;
}

}  // namespace alidade
