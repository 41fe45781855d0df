#include "eval/render/image_sensor.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Vector2d;

constexpr int kLog2Normals = 16;

/// Splitmix64 (Steele, Lea, Flood 2014): numbers that depend on the counter alone.
std::uint64_t Scramble(std::uint64_t counter) {
  counter += 0x9E3779B97F4A7C15ULL;
  counter = (counter ^ (counter >> 30)) * 0xBF58476D1CE4E5B9ULL;
  counter = (counter ^ (counter >> 27)) * 0x94D049BB133111EBULL;
  return counter ^ (counter >> 31);
}

std::vector<float> VignetteOf(const CameraModel& camera, double lost_share) {
  const Vector2d principal(camera.intrinsics()[2], camera.intrinsics()[3]);
  const Vector2d last(camera.width_px() - 1, camera.height_px() - 1);
  const double farthest = principal.cwiseAbs().cwiseMax((last - principal).cwiseAbs()).squaredNorm();
  std::vector<float> shares;
  for (int y = 0; y < camera.height_px(); ++y) {
    for (int x = 0; x < camera.width_px(); ++x) {
      const double share = 1 - lost_share * (Vector2d(x, y) - principal).squaredNorm() / farthest;
      shares.push_back(static_cast<float>(share));
    }
  }
  return shares;
}

}  // namespace

ImageSensor::ImageSensor(const CameraModel& camera, const RenderConfig& config, std::uint64_t seed)
    : width_px_(camera.width_px()),
      height_px_(camera.height_px()),
      read_noise_grey_(static_cast<float>(config.read_noise_grey)),
      shot_noise_grey_(static_cast<float>(config.shot_noise_grey)),
      vignette_(config.vignetting > 0 ? VignetteOf(camera, config.vignetting) : std::vector<float>()),
      seed_(Scramble(seed)) {
  RandomStream stream(seed, "render.noise");
  normals_.resize(std::size_t{1} << kLog2Normals);
  for (float& normal : normals_) {
    normal = static_cast<float>(stream.Normal());
  }
}

GreyImage ImageSensor::Expose(const std::vector<float>& sums, double scale, double gain,
                              std::uint64_t frame) const {
  const auto to_light = static_cast<float>(scale);
  const auto amplified = static_cast<float>(gain);
  const float read = amplified * read_noise_grey_;
  const float shot = amplified * shot_noise_grey_;
  const std::uint64_t key = Scramble(seed_ ^ frame);
  GreyImage image{.width_px = width_px_, .height_px = height_px_, .pixels = {}};
  image.pixels.resize(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    float grey = to_light * sums[i];
    if (!vignette_.empty()) {
      grey *= vignette_[i];
    }
    grey *= amplified;
    const std::uint64_t pick = Scramble(key + i) >> (64 - kLog2Normals);
    const float deviation = std::sqrt(read * read + shot * grey);
    const float exposed = std::clamp(grey + deviation * normals_[pick], 0.0F, 255.0F);
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): not negative
    image.pixels[i] = static_cast<unsigned char>(exposed + 0.5F);
  }
  return image;
}

}  // namespace alidade
