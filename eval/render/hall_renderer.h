#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/camera_model.h"
#include "core/navigation_state.h"
#include "eval/render/exposure_control.h"
#include "eval/render/hall_light.h"
#include "eval/render/hall_view.h"
#include "eval/render/image_sensor.h"
#include "eval/render/render_hall.h"
#include "eval/render/render_texture.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// One image to take.
struct Shot {
  std::function<Pose(double time_s)> T_WC;  ///< of the camera, at hall times; called from one thread
  double middle_s = 0;                      ///< hall time of the middle of the middle row's exposure
  Exposure exposure;
  double light = 1;         ///< factor on the light of the scene, exposure time included
  double blur_px = 0;       ///< deviation of a Gaussian that blurs what reaches the sensor
  std::uint64_t frame = 0;  ///< noise depends on it and the seed alone
};

/// Draws a hall through a camera model, ray by ray.
///
/// A pixel is the mean over `samples` rays; ray k leaves at the k-th of as many times spread evenly over the
/// exposure, from the k-th of as many points of the lens, through the k-th of as many points spread evenly
/// over the pixel's square, unprojected through the lens model once and for all. So one set of rays smooths
/// edges and blurs motion and what is out of focus: the rays of a pixel meet at focus_distance_m (thin lens:
/// Cook, Porter, Carpenter, "Distributed ray tracing", 1984). The rows of a rolling shutter are exposed one
/// after the other, each along the motion at its own time. A ray meets the nearest of room, boxes and columns
/// and takes the grey of the texture there, from the mip level whose texels are as large as the ray's
/// footprint (distance times pixel angle, over the root of the cosine of incidence; or the distance between
/// the rays of a pixel where that is larger out of focus); rays of a pixel round the level at different
/// points, so that levels blend. Of a glossy floor a share of the ray is mirrored (Schlick, "An inexpensive
/// BRDF model", 1994) and meets the hall once more.
///
/// Grey = light * mean of texture times shade times light of the place; then the sensor (image_sensor.h).
/// Neglected: shadows, light that one surface throws on another. Pixels outside the lens model's domain are
/// black.
class HallRenderer {
 public:
  /// line_delay_s: from a row to the next; 0: all rows at once.
  HallRenderer(const CameraModel& camera, const RenderConfig& config, double line_delay_s, Hall hall,
               std::uint64_t seed);

  /// May be called from several threads at once; the image depends on the arguments alone.
  [[nodiscard]] GreyImage Render(const Shot& shot) const;
  /// The mean grey of the image with exposure_s and gain 1, without noise and reflections, from a ray every
  /// kMeterStepPx in either direction; lamps count as white.
  [[nodiscard]] double Meter(const Shot& shot) const;

  [[nodiscard]] const Hall& hall() const { return hall_; }
  [[nodiscard]] const HallLight& light() const { return light_; }

  static constexpr int kMeterStepPx = 24;

 private:
  /// Rows that are exposed at the same time.
  struct Band {
    int first_row = 0;
    std::vector<ViewTile> tiles;
  };
  /// What sample k of a band sees.
  struct SampleView {
    HallView direct;
    std::vector<HallView> mirrored;  ///< in the floor; none of a dull one
  };
  /// Room for the boxes of a tile.
  struct Candidates {
    std::vector<HallView::Candidate> direct;
    std::vector<HallView::Candidate> mirrored;
  };

  void AimRays(const CameraModel& camera);
  void CutBands(bool row_by_row);
  [[nodiscard]] const Eigen::Vector3f& RayOf(std::size_t sample, int x, int y) const;
  [[nodiscard]] double RowTime(const Shot& shot, int row) const;
  [[nodiscard]] std::vector<SampleView> ViewsOf(const Shot& shot, int row) const;
  void RenderTile(const ViewTile& tile, const std::vector<SampleView>& views, Candidates* candidates,
                  std::vector<float>* sums) const;
  [[nodiscard]] float GreyAt(const HallHit& hit, float level_scale) const;
  [[nodiscard]] bool IsFloor(const HallHit& hit) const { return hit.surface == &hall_.room.faces[4]; }
  /// The share of light that the floor mirrors at this incidence.
  [[nodiscard]] float MirroredShare(const HallHit& hit) const;

  int width_px_;
  int height_px_;
  RenderConfig config_;
  double line_delay_s_;
  Hall hall_;
  HallLight light_;
  ImageSensor sensor_;
  std::vector<Texture> textures_;
  float pixel_angle_;
  float texels_per_m_;
  bool plain_light_;                     ///< even, and no lamps
  std::vector<Eigen::Vector3d> lens_C_;  ///< where the rays of each sample leave, camera frame [m]
  /// Of sample k and pixel i at k * pixels + i: unit vector in the camera frame; zero where there is no ray.
  std::vector<Eigen::Vector3f> rays_;
  ViewTile field_;  ///< a cone around all rays
  std::vector<Band> bands_;
};

}  // namespace alidade
