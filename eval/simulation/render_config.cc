#include "eval/simulation/render_config.h"

#include "core/format.h"

namespace alidade {

void RenderConfig::DescribeCamera(ConfigVisitor& visitor) {
  visitor.Real(
      {"exposure_s", "s",
       "exposure time, which causes motion blur; the stamp is its middle; indoor cameras: 0.002 to 0.02"},
      &exposure_s, 0, 0.2);
  visitor.Integer({"samples", "-",
                   "rays a pixel, spread over its area, the exposure and the lens; too few cause aliasing of "
                   "edges, motion blur and defocus"},
                  &samples, 1, 64);
  visitor.Real({"brightness", "-", "factor on all grey values, which are clipped at 255"}, &brightness, 0.01,
               10);
  visitor.Real(
      {"brightness_swing", "-", "relative amplitude of a slow change of brightness, as by exposure control"},
      &brightness_swing, 0, 0.9);
  visitor.Real({"brightness_period_s", "s", "period of that change"}, &brightness_period_s, 0.1, 1e4);
  visitor.Real({"read_noise_grey", "grey",
                "standard deviation of the read noise of each pixel at gain 1; EuRoC: about 1"},
               &read_noise_grey, 0, 100);
  visitor.Real(
      {"shot_noise_grey", "grey", "photon noise: variance of a pixel divided by its grey value, at gain 1"},
      &shot_noise_grey, 0, 10);
  visitor.Real({"gain", "-",
                "amplification after the light was counted: factor on grey values, on the read noise, and on "
                "the variance of photon noise at a given grey; 8 with brightness 0.125 is a dark hall"},
               &gain, 1, 64);
  visitor.Real({"line_delay_s", "s",
                "of a rolling shutter: from the exposure of a row to that of the next; the stamp is the "
                "middle of the exposure of the middle row; phones: 1e-5 to 6e-5; 0: all rows at once, or as "
                "the recording's sheet has it"},
               &line_delay_s, -1e-3, 1e-3);
  visitor.Real(
      {"vignetting", "-",
       "share of the light that is lost in the farthest corner of the image, growing with the square "
       "of the distance from the principal point"},
      &vignetting, 0, 0.95);
  visitor.Real(
      {"aperture_m", "m",
       "diameter of a thin lens; what is not at focus_distance_m is blurred to a disc; 0: a pinhole; "
       "a lens of 6 mm at f/2: 0.003"},
      &aperture_m, 0, 0.1);
  visitor.Real({"focus_distance_m", "m", "depth that a lens with an aperture images sharply"},
               &focus_distance_m, 0.05, 1000);
}

void RenderConfig::DescribeExposureControl(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"auto_exposure", "-",
       "exposure control: exposure time (from 0.1 of exposure_s to exposure_max_s), then gain (to "
       "gain_max), follow the mean grey of the image; exposure_s is the time at which gain 1 gives "
       "the grey of the textures"},
      &auto_exposure);
  visitor.Real({"exposure_target_grey", "grey", "mean grey value that exposure control aims at"},
               &exposure_target_grey, 1, 250);
  visitor.Real({"exposure_max_s", "s", "longest exposure time of the control; bounds motion blur"},
               &exposure_max_s, 1e-5, 0.2);
  visitor.Real({"gain_max", "-", "largest gain of the control; bounds noise"}, &gain_max, 1, 64);
  visitor.Integer({"exposure_delay_frames", "-",
                   "frames from the metered image to the first one exposed by it; sensors: 2 to 4"},
                  &exposure_delay_frames, 1, 20);
  visitor.Real({"exposure_rate", "-",
                "share of the logarithmic error that is corrected in a frame; too large a share oscillates "
                "with the delay"},
               &exposure_rate, 0.01, 1);
  visitor.Real({"exposure_band", "-",
                "relative error of the mean grey that is left uncorrected; a wide band makes steps"},
               &exposure_band, 0, 1);
}

void RenderConfig::DescribeHall(ConfigVisitor& visitor) {
  visitor.Real({"box_density_per_m2", "1/m^2", "boxes on the floor, per square metre"}, &box_density_per_m2,
               0, 10);
  visitor.Real({"panel_density_per_m2", "1/m^2", "panels and beams on walls and ceiling, per square metre"},
               &panel_density_per_m2, 0, 10);
  visitor.Real({"column_density_per_m2", "1/m^2", "columns from floor to ceiling, per square metre of floor"},
               &column_density_per_m2, 0, 10);
  visitor.Real(
      {"texel_m", "m", "finest detail of the textures; the size of a pixel of EuRoC's camera at 3 m"},
      &texel_m, 1e-4, 1);
  visitor.Real({"repetitive_share", "-",
                "share of the faces that show one motif of 32 x 32 texels again and again: corners that look "
                "alike"},
               &repetitive_share, 0, 1);
  visitor.Real({"bare_share", "-",
                "share of the faces that are plain paint: no corners but their edges; applied after "
                "repetitive_share"},
               &bare_share, 0, 1);
}

void RenderConfig::DescribeScene(ConfigVisitor& visitor) {
  visitor.Real({"light_step", "-",
                "share of the light that goes out at once, and comes back, every light_step_period_s"},
               &light_step, 0, 0.99);
  visitor.Real({"light_step_period_s", "s", "time from one step of the light to the next"},
               &light_step_period_s, 0.1, 1e4);
  visitor.Real({"light_contrast", "-",
                "light in the brightest part of the hall divided by that in the darkest; 1: even light"},
               &light_contrast, 1, 100);
  visitor.Real({"lamp_spacing_m", "m",
                "distance of square lamps in the ceiling, which saturate the image; 0: no lamps"},
               &lamp_spacing_m, 0, 100);
  visitor.Real({"floor_gloss", "-",
                "share of the light that the floor reflects as a mirror at normal incidence, more at grazing "
                "incidence (Schlick); polished stone: 0.05 to 0.3; 0: dull"},
               &floor_gloss, 0, 1);
  visitor.Real({"moving_density_per_m2", "1/m^2",
                "textured boxes that move to and fro through the hall, per square metre of floor"},
               &moving_density_per_m2, 0, 1);
  visitor.Real({"moving_speed_mps", "m/s", "their largest speed"}, &moving_speed_mps, 0.01, 10);
}

void RenderConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean({"enabled", "-",
                   "render images; tracks then come from the front end instead of landmarks; the hall is the "
                   "path's bounding box extended by room_margin_m, its objects are at least "
                   "landmark_min_distance_m from the path"},
                  &enabled);
  DescribeCamera(visitor);
  DescribeExposureControl(visitor);
  DescribeHall(visitor);
  DescribeScene(visitor);
}

Status RenderConfig::Validate() const {
  if (auto_exposure && exposure_s <= 0) {
    return Status::Config(
        "render.exposure_s: 0; expected a positive time with render.auto_exposure: it is the time at which "
        "gain 1 gives the grey of the textures");
  }
  if (auto_exposure && exposure_max_s < exposure_s) {
    return Status::Config(Format("render.exposure_max_s: %g; expected at least render.exposure_s %g",
                                 exposure_max_s, exposure_s));
  }
  return Status::Ok();
}

}  // namespace alidade
