#pragma once

#include <cstdint>
#include <vector>

#include "core/camera_model.h"
#include "core/navigation_state.h"
#include "eval/render/hall_view.h"
#include "eval/render/render_hall.h"
#include "eval/render/render_texture.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// Draws a hall through a camera model, ray by ray.
///
/// A pixel is the mean over `samples` rays; ray k leaves from the k-th pose of the exposure, through the k-th
/// of as many points spread evenly over the pixel's square, unprojected through the lens model once and for
/// all. So one set of rays smooths edges and blurs motion. A ray meets the nearest of room, boxes and columns
/// and takes the grey of the texture there, from the mip level whose texels are as large as the ray's
/// footprint (distance times pixel angle, over the root of the cosine of incidence); rays of a pixel round
/// the level at different points, so that levels blend.
///
/// Grey = brightness * mean of texture times shade; the sensor adds noise of variance read^2 + shot * grey
/// that depends on seed and frame alone, and rounds. Neglected: shadows, reflections, vignetting, rolling
/// shutter. Pixels outside the lens model's domain are black.
class HallRenderer {
 public:
  HallRenderer(const CameraModel& camera, const RenderConfig& config, Hall hall, std::uint64_t seed);

  /// T_WC: `samples` poses, evenly over the exposure. brightness: factor on all grey values. May be called
  /// from several threads at once; the image depends on the arguments alone.
  [[nodiscard]] GreyImage Render(const std::vector<Pose>& T_WC, std::uint64_t frame, double brightness) const;

  [[nodiscard]] const Hall& hall() const { return hall_; }

 private:
  void AimRays(const CameraModel& camera);
  void RenderTile(const ViewTile& tile, const std::vector<HallView>& views,
                  std::vector<HallView::Candidate>* candidates, std::vector<float>* sums) const;
  [[nodiscard]] float GreyAt(const HallHit& hit, float level_scale) const;
  [[nodiscard]] unsigned char Expose(float grey, float noise) const;

  int width_px_;
  int height_px_;
  RenderConfig config_;
  Hall hall_;
  std::vector<Texture> textures_;
  float pixel_angle_;
  float texels_per_m_;
  /// Of sample k and pixel i at k * pixels + i: unit vector in the camera frame; zero where there is no ray.
  std::vector<Eigen::Vector3f> rays_;
  ViewTile field_;  ///< a cone around all rays
  std::vector<ViewTile> tiles_;
  std::vector<float> normals_;  ///< standard normal numbers to pick from
  std::uint64_t seed_;
};

}  // namespace alidade
