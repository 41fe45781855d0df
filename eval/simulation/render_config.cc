#include "eval/simulation/render_config.h"

namespace alidade {

void RenderConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean({"enabled", "-",
                   "render images; tracks then come from the front end instead of landmarks; the hall is the "
                   "path's bounding box extended by room_margin_m, its objects are at least "
                   "landmark_min_distance_m from the path"},
                  &enabled);
  visitor.Real(
      {"exposure_s", "s",
       "exposure time, which causes motion blur; the stamp is its middle; indoor cameras: 0.002 to 0.02"},
      &exposure_s, 0, 0.2);
  visitor.Integer({"samples", "-",
                   "rays a pixel, spread over its area and the exposure; too few cause aliasing of edges and "
                   "motion blur"},
                  &samples, 1, 64);
  visitor.Real({"brightness", "-", "factor on all grey values, which are clipped at 255"}, &brightness, 0.01,
               10);
  visitor.Real(
      {"brightness_swing", "-", "relative amplitude of a slow change of brightness, as by exposure control"},
      &brightness_swing, 0, 0.9);
  visitor.Real({"brightness_period_s", "s", "period of that change"}, &brightness_period_s, 0.1, 1e4);
  visitor.Real(
      {"read_noise_grey", "grey", "standard deviation of the read noise of each pixel; EuRoC: about 1"},
      &read_noise_grey, 0, 100);
  visitor.Real({"shot_noise_grey", "grey", "photon noise: variance of a pixel divided by its grey value"},
               &shot_noise_grey, 0, 10);
  visitor.Real({"box_density_per_m2", "1/m^2", "boxes on the floor, per square metre"}, &box_density_per_m2,
               0, 10);
  visitor.Real({"panel_density_per_m2", "1/m^2", "panels and beams on walls and ceiling, per square metre"},
               &panel_density_per_m2, 0, 10);
  visitor.Real({"column_density_per_m2", "1/m^2", "columns from floor to ceiling, per square metre of floor"},
               &column_density_per_m2, 0, 10);
  visitor.Real(
      {"texel_m", "m", "finest detail of the textures; the size of a pixel of EuRoC's camera at 3 m"},
      &texel_m, 1e-4, 1);
}

}  // namespace alidade
