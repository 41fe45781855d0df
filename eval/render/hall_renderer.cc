#include "eval/render/hall_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/check.h"
#include "core/random.h"
#include "core/visual_observation.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr int kLog2TextureSize = 10;
constexpr int kLog2Normals = 16;

/// Points of the unit square around its middle, spread by the additive recurrence of the plastic number
/// (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018); their mean is the middle, so
/// that no image is shifted.
std::vector<Vector2d> PointsOfPixel(int count) {
  constexpr double kPlastic = 1.32471795724474602596;
  std::vector<Vector2d> points;
  Vector2d mean = Vector2d::Zero();
  for (int k = 0; k < count; ++k) {
    Vector2d point(0.5 + k / kPlastic, 0.5 + k / (kPlastic * kPlastic));
    point -= point.array().floor().matrix();
    points.push_back(point);
    mean += point / count;
  }
  for (Vector2d& point : points) {
    point -= mean;
  }
  return points;
}

/// Splitmix64 (Steele, Lea, Flood 2014): numbers that depend on the counter alone.
std::uint64_t Scramble(std::uint64_t counter) {
  counter += 0x9E3779B97F4A7C15ULL;
  counter = (counter ^ (counter >> 30)) * 0xBF58476D1CE4E5B9ULL;
  counter = (counter ^ (counter >> 27)) * 0x94D049BB133111EBULL;
  return counter ^ (counter >> 31);
}

/// floor(log2(x) / 2) of a positive number, 0 below 1.
int HalfLog2(float x) {
  const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(x) >> 23) - 127;
  return std::max(exponent, 0) / 2;
}

}  // namespace

HallRenderer::HallRenderer(const CameraModel& camera, const RenderConfig& config, Hall hall,
                           std::uint64_t seed)
    : width_px_(camera.width_px()),
      height_px_(camera.height_px()),
      config_(config),
      hall_(std::move(hall)),
      pixel_angle_(static_cast<float>(1 / camera.mean_focal_px())),
      texels_per_m_(static_cast<float>(1 / config.texel_m)),
      seed_(Scramble(seed)) {
  for (int kind = 0; kind < kTextureKinds; ++kind) {
    textures_.push_back(MakeTexture(static_cast<TextureKind>(kind), kLog2TextureSize, seed));
  }
  RandomStream stream(seed, "render.noise");
  normals_.resize(std::size_t{1} << kLog2Normals);
  for (float& normal : normals_) {
    normal = static_cast<float>(stream.Normal());
  }
  AimRays(camera);
}

void HallRenderer::AimRays(const CameraModel& camera) {
  const std::vector<Vector2d> points = PointsOfPixel(config_.samples);
  const auto pixels = static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_);
  rays_.assign(points.size() * pixels, Vector3f::Zero());
  for (int y = 0; y < height_px_; ++y) {
    for (int x = 0; x < width_px_; ++x) {
      NormalizedObservation middle;
      if (!NormalizeObservation(camera, Vector2d(x, y), 1.0, &middle)) {
        continue;
      }
      // Within half a pixel the lens is linear to 1e-4 px.
      const Eigen::Matrix2d inverse = middle.sqrt_information.inverse();
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Vector2d at = middle.z + inverse * points[k];
        rays_[k * pixels + static_cast<std::size_t>(y * width_px_ + x)] =
            middle.plane.Direction(at).normalized().cast<float>();
      }
    }
  }
  field_ = ViewTile::Around(0, 0, rays_);
  for (int y = 0; y < height_px_; y += ViewTile::kSidePx) {
    for (int x = 0; x < width_px_; x += ViewTile::kSidePx) {
      std::vector<Vector3f> rays;
      for (std::size_t k = 0; k < points.size(); ++k) {
        for (int row = y; row < std::min(y + ViewTile::kSidePx, height_px_); ++row) {
          for (int column = x; column < std::min(x + ViewTile::kSidePx, width_px_); ++column) {
            rays.push_back(rays_[k * pixels + static_cast<std::size_t>(row * width_px_ + column)]);
          }
        }
      }
      tiles_.push_back(ViewTile::Around(x, y, rays));
    }
  }
}

float HallRenderer::GreyAt(const HallHit& hit, float level_scale) const {
  const Surface& surface = *hit.surface;
  const float footprint = hit.distance * level_scale;
  const int level = HalfLog2(footprint * footprint / std::max(hit.cosine, 0.02F));
  const Texture& texture = textures_[static_cast<std::size_t>(surface.texture)];
  return surface.shade * texture.At((hit.x_m + surface.offset_m.x()) * texels_per_m_,
                                    (hit.y_m + surface.offset_m.y()) * texels_per_m_, level);
}

void HallRenderer::RenderTile(const ViewTile& tile, const std::vector<HallView>& views,
                              std::vector<HallView::Candidate>* candidates, std::vector<float>* sums) const {
  const auto pixels = static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_);
  const int bottom = std::min(tile.y + ViewTile::kSidePx, height_px_);
  const int right = std::min(tile.x + ViewTile::kSidePx, width_px_);
  for (std::size_t k = 0; k < views.size(); ++k) {
    views[k].ListCandidates(tile, candidates);
    // From half a level finer to half a level coarser over the samples; truncation rounds each.
    const float share = (static_cast<float>(k) + 0.5F) / static_cast<float>(views.size());
    const float level_scale = pixel_angle_ * texels_per_m_ * std::exp2(share - 0.5F);
    for (int y = tile.y; y < bottom; ++y) {
      for (int x = tile.x; x < right; ++x) {
        const auto pixel = static_cast<std::size_t>(y * width_px_ + x);
        const Vector3f& ray = rays_[k * pixels + pixel];
        if (!ray.isZero(0)) {
          (*sums)[pixel] += GreyAt(views[k].Cast(ray, *candidates), level_scale);
        }
      }
    }
  }
}

unsigned char HallRenderer::Expose(float grey, float noise) const {
  const auto read = static_cast<float>(config_.read_noise_grey);
  const float deviation = std::sqrt(read * read + static_cast<float>(config_.shot_noise_grey) * grey);
  const float exposed = std::clamp(grey + deviation * noise, 0.0F, 255.0F);
  return static_cast<unsigned char>(exposed + 0.5F);  // NOLINT(bugprone-incorrect-roundings): not negative
}

GreyImage HallRenderer::Render(const std::vector<Pose>& T_WC, std::uint64_t frame, double brightness) const {
  CHECK_EQ(T_WC.size(), static_cast<std::size_t>(config_.samples));
  std::vector<HallView> views;
  views.reserve(T_WC.size());
  for (const Pose& pose : T_WC) {
    views.emplace_back(hall_, pose, field_);
  }
  std::vector<float> sums(static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_));
  std::vector<HallView::Candidate> candidates;
  for (const ViewTile& tile : tiles_) {
    RenderTile(tile, views, &candidates, &sums);
  }
  const auto scale = static_cast<float>(brightness * config_.brightness / config_.samples);
  const std::uint64_t key = Scramble(seed_ ^ frame);
  GreyImage image{.width_px = width_px_, .height_px = height_px_, .pixels = {}};
  image.pixels.resize(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const std::uint64_t pick = Scramble(key + i) >> (64 - kLog2Normals);
    image.pixels[i] = Expose(scale * sums[i], normals_[pick]);
  }
  return image;
}

}  // namespace alidade
