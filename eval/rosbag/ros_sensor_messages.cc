#include "eval/rosbag/ros_sensor_messages.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "eval/rosbag/ros_header.h"

namespace alidade {
namespace {

constexpr int kMaxSidePx = 100000;
constexpr double kMaxRotationError = 1e-9;

/// A covariance of 3 x 3 of which nothing is known; -1 at its head means that the quantity itself is missing.
void PutUnknownCovariance(double head, ByteWriter* out) {
  out->Write(head);
  for (int i = 1; i < 9; ++i) {
    out->Write(0.0);
  }
}

/// How the samples of an encoding lie in a pixel.
struct PixelLayout {
  std::string_view encoding;
  int channels = 1;
  int bytes = 1;  ///< a channel
  int red = 0, green = 0, blue = 0;
};
constexpr std::array<PixelLayout, 8> kLayouts = {{{"mono8"},
                                                  {"8UC1"},
                                                  {"mono16", 1, 2},
                                                  {"16UC1", 1, 2},
                                                  {"bgr8", 3, 1, 2, 1, 0},
                                                  {"rgb8", 3, 1, 0, 1, 2},
                                                  {"bgra8", 4, 1, 2, 1, 0},
                                                  {"rgba8", 4, 1, 0, 1, 2}}};

unsigned char GreyPixel(const PixelLayout& layout, bool big_endian, const unsigned char* pixel) {
  if (layout.bytes == 2) {
    const int value = big_endian ? 256 * pixel[0] + pixel[1] : 256 * pixel[1] + pixel[0];
    return static_cast<unsigned char>(std::lround(value * (255.0 / 65535.0)));
  }
  if (layout.channels == 1) {
    return *pixel;
  }
  const double grey = 0.299 * pixel[layout.red] + 0.587 * pixel[layout.green] + 0.114 * pixel[layout.blue];
  return static_cast<unsigned char>(std::lround(grey));
}

}  // namespace

std::string EncodeImu(const ImuSample& sample) {
  ByteWriter out;
  PutRosHeader(sample.stamp_ns, &out);
  for (const double q : {0.0, 0.0, 0.0, 1.0}) {
    out.Write(q);
  }
  PutUnknownCovariance(-1, &out);
  PutRosVector(sample.gyro, &out);
  PutUnknownCovariance(0, &out);
  PutRosVector(sample.accel, &out);
  PutUnknownCovariance(0, &out);
  return std::move(out.bytes());
}

std::optional<ImuSample> DecodeImu(std::string_view bytes) {
  ByteReader in(bytes);
  ImuSample sample;
  sample.stamp_ns = TakeRosHeader(&in);
  constexpr std::size_t kCovariance = 9 * sizeof(double);
  static_cast<void>(in.Take(4 * sizeof(double) + kCovariance));
  sample.gyro = TakeRosVector(&in);
  static_cast<void>(in.Take(kCovariance));
  sample.accel = TakeRosVector(&in);
  static_cast<void>(in.Take(kCovariance));
  const bool fine = in.ok() && sample.gyro.allFinite() && sample.accel.allFinite();
  return fine ? std::optional(sample) : std::nullopt;
}

std::string EncodeImage(TimeNs stamp_ns, int width_px, int height_px, std::string_view grey) {
  ByteWriter out;
  PutRosHeader(stamp_ns, &out);
  out.Write(static_cast<std::uint32_t>(height_px));
  out.Write(static_cast<std::uint32_t>(width_px));
  out.Block("mono8");
  out.Write(std::uint8_t{0});
  out.Write(static_cast<std::uint32_t>(width_px));
  out.Block(grey);
  return std::move(out.bytes());
}

std::optional<RawImage> DecodeImage(std::string_view bytes) {
  ByteReader in(bytes);
  RawImage image;
  image.stamp_ns = TakeRosHeader(&in);
  const auto height = in.Read<std::uint32_t>();
  const auto width = in.Read<std::uint32_t>();
  image.encoding = std::string(in.Block());
  image.big_endian = in.Read<std::uint8_t>() != 0;
  image.step = in.Read<std::uint32_t>();
  image.data = in.Block();
  if (!in.ok() || height == 0 || width == 0 || height > kMaxSidePx || width > kMaxSidePx ||
      image.data.size() != image.step * height) {
    return std::nullopt;
  }
  image.width_px = static_cast<int>(width);
  image.height_px = static_cast<int>(height);
  return image;
}

std::optional<GreyImage> GreyOf(const RawImage& image) {
  const auto layout = std::find_if(kLayouts.begin(), kLayouts.end(), [&](const PixelLayout& known) {
    return known.encoding == image.encoding;
  });
  if (layout == kLayouts.end()) {
    return std::nullopt;
  }
  const auto stride = static_cast<std::size_t>(layout->channels * layout->bytes);
  const auto width = static_cast<std::size_t>(image.width_px);
  const auto height = static_cast<std::size_t>(image.height_px);
  if (image.step < width * stride) {
    return std::nullopt;
  }
  GreyImage grey{image.width_px, image.height_px, std::vector<unsigned char>(width * height)};
  const auto* data = reinterpret_cast<const unsigned char*>(image.data.data());
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      grey.pixels[row * width + column] =
          GreyPixel(*layout, image.big_endian, data + row * image.step + column * stride);
    }
  }
  return grey;
}

std::optional<CompressedImage> DecodeCompressedImage(std::string_view bytes) {
  ByteReader in(bytes);
  CompressedImage image;
  image.stamp_ns = TakeRosHeader(&in);
  static_cast<void>(in.Block());
  image.file = in.Block();
  return in.ok() && !image.file.empty() ? std::optional(image) : std::nullopt;
}

std::string EncodeTracks(const TrackFrame& frame) {
  ByteWriter out;
  PutRosHeader(frame.stamp_ns, &out);
  std::vector<std::int64_t> ids;
  std::vector<double> u, v, noise_ratios;
  for (const TrackObservation& observation : frame.observations) {
    ids.push_back(observation.track_id);
    u.push_back(observation.pixel.x());
    v.push_back(observation.pixel.y());
    noise_ratios.push_back(observation.noise_ratio);
  }
  out.Array(ids);
  out.Array(u);
  out.Array(v);
  out.Array(noise_ratios);
  return std::move(out.bytes());
}

std::optional<TrackFrame> DecodeTracks(std::string_view bytes) {
  ByteReader in(bytes);
  TrackFrame frame;
  frame.stamp_ns = TakeRosHeader(&in);
  const std::vector<std::int64_t> ids = in.Array<std::int64_t>();
  const std::vector<double> u = in.Array<double>();
  const std::vector<double> v = in.Array<double>();
  // Bags of earlier versions have none.
  const std::vector<double> noise_ratios =
      in.left() > 0 ? in.Array<double>() : std::vector<double>(ids.size(), 1);
  if (!in.ok() || u.size() != ids.size() || v.size() != ids.size() || noise_ratios.size() != ids.size()) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    // Sorted by id, each once: what a frame promises.
    if (ids[i] < 0 || (i > 0 && ids[i] <= ids[i - 1]) || !std::isfinite(u[i]) || !std::isfinite(v[i]) ||
        !(noise_ratios[i] > 0) || !std::isfinite(noise_ratios[i])) {
      return std::nullopt;
    }
    frame.observations.push_back({ids[i], {u[i], v[i]}, noise_ratios[i]});
  }
  return frame;
}

std::string EncodeState(const TrajectoryPoint& point, bool has_velocity) {
  ByteWriter out;
  PutRosHeader(point.stamp_ns, &out);
  PutRosVector(point.nav.p_WB, &out);
  for (int i = 0; i < 9; ++i) {
    out.Write(point.nav.R_WB(i / 3, i % 3));
  }
  out.Write(static_cast<std::uint8_t>(has_velocity));
  PutRosVector(point.nav.v_WB, &out);
  PutRosVector(point.bias.gyro, &out);
  PutRosVector(point.bias.accel, &out);
  return std::move(out.bytes());
}

std::optional<DecodedState> DecodeState(std::string_view bytes) {
  ByteReader in(bytes);
  DecodedState state;
  TrajectoryPoint& point = state.point;
  point.stamp_ns = TakeRosHeader(&in);
  point.nav.p_WB = TakeRosVector(&in);
  Eigen::Matrix3d& R_WB = point.nav.R_WB;
  for (int i = 0; i < 9; ++i) {
    R_WB(i / 3, i % 3) = in.Read<double>();
  }
  state.has_velocity = in.Read<std::uint8_t>() != 0;
  point.nav.v_WB = TakeRosVector(&in);
  point.bias.gyro = TakeRosVector(&in);
  point.bias.accel = TakeRosVector(&in);
  const bool finite = point.nav.p_WB.allFinite() && point.nav.v_WB.allFinite() &&
                      point.bias.gyro.allFinite() && point.bias.accel.allFinite();
  const bool is_rotation = (R_WB.transpose() * R_WB).isIdentity(kMaxRotationError) && R_WB.determinant() > 0;
  if (!in.ok() || !finite || !is_rotation) {
    return std::nullopt;
  }
  return state;
}

std::string EncodeText(std::string_view text) {
  ByteWriter out;
  out.Block(text);
  return std::move(out.bytes());
}

std::optional<std::string> DecodeText(std::string_view bytes) {
  ByteReader in(bytes);
  const std::string_view text = in.Block();
  return in.ok() ? std::optional(std::string(text)) : std::nullopt;
}

}  // namespace alidade
