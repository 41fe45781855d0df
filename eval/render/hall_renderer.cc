#include "eval/render/hall_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/visual_observation.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr int kLog2TextureSize = 10;
constexpr int kTilePx = 16;
constexpr int kRowTilePx = 64;  // of a rolling shutter: a tile is part of one row

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

/// As many points of a disc around zero, evenly (Vogel's spiral), in an order that has nothing to do with
/// that of the times; their mean is zero, so that what is out of focus is not shifted.
std::vector<Eigen::Vector3d> PointsOfLens(int count, double diameter_m) {
  std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(count), Eigen::Vector3d::Zero());
  constexpr double kGoldenAngle = std::numbers::pi * (3 - 2.23606797749978969);
  int stride = std::max(1, static_cast<int>(0.618 * count));
  while (std::gcd(stride, count) > 1) {
    ++stride;
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int k = 0; k < count; ++k) {
    const int at = k * stride % count;
    const double radius = 0.5 * diameter_m * std::sqrt((at + 0.5) / count);
    points[static_cast<std::size_t>(k)] = {radius * std::cos(kGoldenAngle * at),
                                           radius * std::sin(kGoldenAngle * at), 0};
    mean += points[static_cast<std::size_t>(k)] / count;
  }
  for (Eigen::Vector3d& point : points) {
    point -= mean;
  }
  return points;
}

/// floor(log2(x) / 2) of a positive number, 0 below 1.
int HalfLog2(float x) {
  const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(x) >> 23) - 127;
  return std::max(exponent, 0) / 2;
}

}  // namespace

HallRenderer::HallRenderer(const CameraModel& camera, const RenderConfig& config, double line_delay_s,
                           Hall hall, std::uint64_t seed)
    : width_px_(camera.width_px()),
      height_px_(camera.height_px()),
      config_(config),
      line_delay_s_(line_delay_s),
      hall_(std::move(hall)),
      light_(config, seed),
      sensor_(camera, config, seed),
      pixel_angle_(static_cast<float>(1 / camera.mean_focal_px())),
      texels_per_m_(static_cast<float>(1 / config.texel_m)),
      plain_light_(light_.is_even() && config.lamp_spacing_m == 0),
      lens_C_(PointsOfLens(config.samples, config.aperture_m)) {
  for (int kind = 0; kind < kTextureKinds; ++kind) {
    textures_.push_back(MakeTexture(static_cast<TextureKind>(kind), kLog2TextureSize, seed));
  }
  AimRays(camera);
  CutBands(line_delay_s != 0);
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
        Eigen::Vector3d ray = middle.plane.Direction(middle.z + inverse * points[k]);
        if (config_.aperture_m > 0) {
          ray = config_.focus_distance_m * ray - lens_C_[k];
        }
        rays_[k * pixels + static_cast<std::size_t>(y * width_px_ + x)] = ray.normalized().cast<float>();
      }
    }
  }
  field_ = ViewTile::Around(rays_);
}

void HallRenderer::CutBands(bool row_by_row) {
  const int tile_width = row_by_row ? kRowTilePx : kTilePx;
  const int tile_height = row_by_row ? 1 : kTilePx;
  for (int y = 0; y < height_px_; y += tile_height) {
    if (row_by_row || bands_.empty()) {
      bands_.push_back({.first_row = y, .tiles = {}});
    }
    for (int x = 0; x < width_px_; x += tile_width) {
      const int right = std::min(x + tile_width, width_px_);
      const int bottom = std::min(y + tile_height, height_px_);
      std::vector<Vector3f> rays;
      for (std::size_t k = 0; k < lens_C_.size(); ++k) {
        for (int row = y; row < bottom; ++row) {
          for (int column = x; column < right; ++column) {
            rays.push_back(RayOf(k, column, row));
          }
        }
      }
      ViewTile tile = ViewTile::Around(rays);
      tile.x = x;
      tile.y = y;
      tile.right = right;
      tile.bottom = bottom;
      bands_.back().tiles.push_back(tile);
    }
  }
}

const Vector3f& HallRenderer::RayOf(std::size_t sample, int x, int y) const {
  const auto pixels = static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_);
  return rays_[sample * pixels + static_cast<std::size_t>(y * width_px_ + x)];
}

double HallRenderer::RowTime(const Shot& shot, int row) const {
  return line_delay_s_ == 0 ? shot.middle_s : shot.middle_s + line_delay_s_ * (row - 0.5 * height_px_);
}

std::vector<HallRenderer::SampleView> HallRenderer::ViewsOf(const Shot& shot, int row) const {
  std::vector<SampleView> views;
  views.reserve(lens_C_.size());
  const double time_s = RowTime(shot, row);
  for (std::size_t k = 0; k < lens_C_.size(); ++k) {
    const double share = (static_cast<double>(k) + 0.5) / config_.samples - 0.5;
    const double sample_s = time_s + share * shot.exposure.time_s;
    Pose T_WC = shot.T_WC(sample_s);
    if (config_.aperture_m > 0) {
      T_WC.translation += T_WC.rotation * lens_C_[k];
    }
    views.push_back({HallView(hall_, T_WC, field_, sample_s), {}});
    if (config_.floor_gloss > 0) {
      views.back().mirrored.push_back(HallView::InFloor(hall_, T_WC, field_, sample_s));
    }
  }
  return views;
}

float HallRenderer::GreyAt(const HallHit& hit, float level_scale) const {
  const Surface& surface = *hit.surface;
  float footprint = hit.distance * level_scale;
  if (config_.aperture_m > 0) {
    // The rays of a pixel share the disc of confusion, aperture |distance - focus| / focus across.
    const auto focus = static_cast<float>(config_.focus_distance_m);
    const float disc = static_cast<float>(config_.aperture_m) * std::abs(hit.distance - focus) / focus;
    footprint = std::max(footprint, disc * texels_per_m_ / std::sqrt(static_cast<float>(config_.samples)));
  }
  const int level = HalfLog2(footprint * footprint / std::max(hit.cosine, 0.02F));
  const Texture& texture = textures_[static_cast<std::size_t>(surface.texture)];
  const float grey = surface.shade * texture.At((hit.x_m + surface.offset_m.x()) * texels_per_m_,
                                                (hit.y_m + surface.offset_m.y()) * texels_per_m_, level);
  if (plain_light_) {
    return grey;
  }
  if (hit.surface == &hall_.room.faces[5] && light_.IsLamp(hit.place)) {
    return HallLight::kLampGrey;
  }
  return light_.is_even() ? grey : grey * light_.At(hit.place);
}

float HallRenderer::MirroredShare(const HallHit& hit) const {
  const auto normal = static_cast<float>(config_.floor_gloss);
  const float grazing = 1 - std::min(hit.cosine, 1.0F);
  const float square = grazing * grazing;
  return normal + (1 - normal) * square * square * grazing;
}

void HallRenderer::RenderTile(const ViewTile& tile, const std::vector<SampleView>& views,
                              Candidates* candidates, std::vector<float>* sums) const {
  for (std::size_t k = 0; k < views.size(); ++k) {
    const SampleView& view = views[k];
    view.direct.ListCandidates(tile, &candidates->direct);
    bool mirrored_listed = false;
    // From half a level finer to half a level coarser over the samples; truncation rounds each.
    const float share = (static_cast<float>(k) + 0.5F) / static_cast<float>(views.size());
    const float level_scale = pixel_angle_ * texels_per_m_ * std::exp2(share - 0.5F);
    for (int y = tile.y; y < tile.bottom; ++y) {
      for (int x = tile.x; x < tile.right; ++x) {
        const Vector3f& ray = RayOf(k, x, y);
        if (ray.isZero(0)) {
          continue;
        }
        const HallHit hit = view.direct.Cast(ray, candidates->direct);
        float grey = GreyAt(hit, level_scale);
        if (!view.mirrored.empty() && IsFloor(hit)) {
          const HallView& mirrored = view.mirrored.front();
          if (!mirrored_listed) {
            mirrored.ListCandidates(tile, &candidates->mirrored);
            mirrored_listed = true;
          }
          const float seen = GreyAt(mirrored.Cast(ray, candidates->mirrored), level_scale);
          grey += MirroredShare(hit) * (seen - grey);
        }
        (*sums)[static_cast<std::size_t>(y * width_px_ + x)] += grey;
      }
    }
  }
}

GreyImage HallRenderer::Render(const Shot& shot) const {
  std::vector<float> sums(static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_));
  Candidates candidates;
  for (const Band& band : bands_) {
    const std::vector<SampleView> views = ViewsOf(shot, band.first_row);
    for (const ViewTile& tile : band.tiles) {
      RenderTile(tile, views, &candidates, &sums);
    }
  }
  if (shot.blur_px > 0) {
    cv::Mat light(height_px_, width_px_, CV_32FC1, sums.data());
    cv::GaussianBlur(light, light, cv::Size(), shot.blur_px, shot.blur_px, cv::BORDER_REPLICATE);
  }
  const double scale = shot.light * config_.brightness / config_.samples;
  return sensor_.Expose(sums, scale, shot.exposure.gain, shot.frame);
}

double HallRenderer::Meter(const Shot& shot) const {
  const HallView view(hall_, shot.T_WC(shot.middle_s), field_, shot.middle_s);
  std::vector<HallView::Candidate> candidates;
  view.ListCandidates(field_, &candidates);
  const float level_scale = static_cast<float>(kMeterStepPx) * pixel_angle_ * texels_per_m_;
  double sum = 0;
  int count = 0;
  for (int y = kMeterStepPx / 2; y < height_px_; y += kMeterStepPx) {
    for (int x = kMeterStepPx / 2; x < width_px_; x += kMeterStepPx) {
      const Vector3f& ray = RayOf(0, x, y);
      const auto pixel = static_cast<std::size_t>(y * width_px_ + x);
      const float share = sensor_.vignette().empty() ? 1 : sensor_.vignette()[pixel];
      if (!ray.isZero(0)) {
        const float grey = std::min(GreyAt(view.Cast(ray, candidates), level_scale), 255.0F);
        sum += static_cast<double>(share * grey);
      }
      ++count;
    }
  }
  return shot.light * config_.brightness * sum / std::max(count, 1);
}

}  // namespace alidade
