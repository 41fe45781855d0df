#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "core/imu_sample.h"
#include "core/track_frame.h"
#include "eval/trajectory/trajectory.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

// Conversion of serialised ROS messages of a bag, in both directions. A decoder returns nothing when the
// bytes are torn or invalid; it allocates no more than the size of the bytes. Stamps are those of the header.

[[nodiscard]] std::string EncodeImu(const ImuSample& sample);
[[nodiscard]] std::optional<ImuSample> DecodeImu(std::string_view bytes);

/// A sensor_msgs/Image with its rows as sent.
struct RawImage {
  TimeNs stamp_ns = 0;
  int width_px = 0;
  int height_px = 0;
  std::string encoding;     ///< mono8, 8UC1, mono16, 16UC1, bgr8, rgb8, bgra8, rgba8, ...
  bool big_endian = false;  ///< of 16-bit samples
  std::size_t step = 0;     ///< bytes a row
  std::string_view data;    ///< step * height_px bytes
};
/// An 8-bit grey image, row-major without gaps.
[[nodiscard]] std::string EncodeImage(TimeNs stamp_ns, int width_px, int height_px, std::string_view grey);
[[nodiscard]] std::optional<RawImage> DecodeImage(std::string_view bytes);
/// 8-bit grey pixels of a raw image: 16-bit samples are scaled, colours weighted by ITU-R BT.601. Empty for
/// other encodings (Bayer, float).
[[nodiscard]] std::optional<GreyImage> GreyOf(const RawImage& image);

/// A sensor_msgs/CompressedImage: the bytes of a PNG or JPEG file.
struct CompressedImage {
  TimeNs stamp_ns = 0;
  std::string_view file;
};
[[nodiscard]] std::optional<CompressedImage> DecodeCompressedImage(std::string_view bytes);

/// alidade/Tracks: all observations of one camera frame.
[[nodiscard]] std::string EncodeTracks(const TrackFrame& frame);
[[nodiscard]] std::optional<TrackFrame> DecodeTracks(std::string_view bytes);

/// alidade/State: a row of the ground truth, its rotation as a matrix, to avoid rounding.
[[nodiscard]] std::string EncodeState(const TrajectoryPoint& point, bool has_velocity);
struct DecodedState {
  TrajectoryPoint point;
  bool has_velocity = false;
};
[[nodiscard]] std::optional<DecodedState> DecodeState(std::string_view bytes);

/// std_msgs/String.
[[nodiscard]] std::string EncodeText(std::string_view text);
[[nodiscard]] std::optional<std::string> DecodeText(std::string_view bytes);

}  // namespace alidade
