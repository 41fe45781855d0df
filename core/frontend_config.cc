#include "core/frontend_config.h"

namespace alidade {

void FrontendConfig::Describe(ConfigVisitor& visitor) {
  visitor.Integer({"max_features", "-", "largest number of tracks in an image"}, &max_features, 10, 2000);
  visitor.Real({"min_distance_px", "px", "smallest distance between two tracks"}, &min_distance_px, 1, 200);
  visitor.Real({"edge_share", "-",
                "distance from the edge, as a share of the image's shorter side, within which no track "
                "begins"},
               &edge_share, 0, 0.3);
  visitor.Integer(
      {"grid_columns", "-", "corners are detected per grid cell, so they are distributed over the image"},
      &grid_columns, 1, 64);
  visitor.Integer({"grid_rows", "-", "see grid_columns"}, &grid_rows, 1, 64);
  visitor.Real(
      {"corner_threshold", "grey",
       "smallest contrast of a corner; one much weaker than the strongest of the image is refused too"},
      &corner_threshold, 1, 200);
  visitor.Integer({"pyramid_levels", "-", "pyramid levels above the full image"}, &pyramid_levels, 0, 6);
  visitor.Integer({"window_px", "px",
                   "side of the KLT window; a larger one is more affected by deformation of the image"},
                  &window_px, 5, 61);
  visitor.Integer(
      {"template_px", "px",
       "side of the patch kept from a track's first image; every image is matched to it under an affine "
       "deformation, which prevents drift of the track; 0 tracks from frame to frame only"},
      &template_px, 0, 41);
  visitor.Real({"min_correlation", "-",
                "smallest correlation of the image with that patch; below it the track must be followed "
                "back, and takes a new patch"},
               &min_correlation, 0, 1);
  visitor.Real({"ransac_threshold_px", "px", "largest distance to the epipolar line"}, &ransac_threshold_px,
               0.1, 20);
  visitor.Real({"forward_backward_px", "px",
                "largest distance between a point and its backward track, from frame to frame; 0 skips the "
                "backward pass"},
               &forward_backward_px, 0, 10);
  visitor.Boolean(
      {"equalize", "-", "CLAHE before tracking; raises the contrast of dark images, and their noise"},
      &equalize);
  visitor.Boolean({"imu_prediction", "-", "start the search of each track at the gyroscope's prediction"},
                  &imu_prediction);
}

}  // namespace alidade
