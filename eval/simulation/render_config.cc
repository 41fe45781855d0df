#include "eval/simulation/render_config.h"

namespace alidade {

void RenderConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"enabled", "-",
       "draws what the camera sees; tracks then come from the front end instead of landmarks; the "
       "hall is the path's bounding box extended by room_margin_m, nothing in it is nearer to the "
       "path than landmark_min_distance_m"},
      &enabled);
  visitor.Real({"exposure_s", "s", "motion blur; the stamp is its middle; indoor cameras: 0.002 to 0.02"},
               &exposure_s, 0, 0.2);
  visitor.Integer({"samples", "-",
                   "rays a pixel, spread over its area and the exposure; fewer show edges as stairs and blur "
                   "as echoes"},
                  &samples, 1, 64);
  visitor.Real({"brightness", "-", "factor on all grey values; what exceeds 255 is white"}, &brightness, 0.01,
               10);
  visitor.Real({"brightness_swing", "-",
                "relative amplitude of a slow change of brightness, as of an exposure control"},
               &brightness_swing, 0, 0.9);
  visitor.Real({"brightness_period_s", "s", "of that change"}, &brightness_period_s, 0.1, 1e4);
  visitor.Real({"read_noise_grey", "grey", "standard deviation, the same in every pixel; EuRoC's: about 1"},
               &read_noise_grey, 0, 100);
  visitor.Real({"shot_noise_grey", "grey", "variance of a pixel over its grey value, of counting photons"},
               &shot_noise_grey, 0, 10);
  visitor.Real({"box_density_per_m2", "1/m^2", "boxes standing on the floor, each square metre of it"},
               &box_density_per_m2, 0, 10);
  visitor.Real({"panel_density_per_m2", "1/m^2", "panels and beams standing out of walls and ceiling"},
               &panel_density_per_m2, 0, 10);
  visitor.Real({"column_density_per_m2", "1/m^2", "columns from floor to ceiling"}, &column_density_per_m2, 0,
               10);
  visitor.Real({"texel_m", "m", "finest detail of the surfaces; a pixel of EuRoC's camera covers it at 3 m"},
               &texel_m, 1e-4, 1);
}

}  // namespace alidade
