#include "eval/render/exposure_control.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade {
namespace {

RenderConfig Controlled() {
  RenderConfig config;
  config.auto_exposure = true;
  return config;
}

double GreyOf(const RenderConfig& config, const Exposure& exposure, double scene) {
  return scene * exposure.time_s / config.exposure_s * exposure.gain;
}

TEST(ExposureControl, GIVEN_an_even_scene_THEN_the_exposure_is_settled_from_the_start) {
  const RenderConfig config = Controlled();
  for (const Exposure& exposure : ControlExposure(config, std::vector<double>(20, 80))) {
    EXPECT_NEAR(GreyOf(config, exposure, 80), config.exposure_target_grey, 1e-9);
    EXPECT_EQ(exposure.gain, 1) << "the time suffices";
  }
}

TEST(ExposureControl, GIVEN_lights_that_go_out_THEN_it_answers_late_first_with_time_then_with_gain) {
  RenderConfig config = Controlled();
  config.exposure_delay_frames = 3;
  std::vector<double> scene(60, 100);
  for (std::size_t i = 10; i < scene.size(); ++i) {
    scene[i] = 8;
  }
  const std::vector<Exposure> exposures = ControlExposure(config, scene);
  EXPECT_EQ(exposures[12].time_s, exposures[9].time_s) << "not before the delay";
  EXPECT_GT(exposures[13].time_s, exposures[12].time_s);
  for (const Exposure& exposure : exposures) {
    EXPECT_TRUE(exposure.gain == 1 || exposure.time_s == config.exposure_max_s);
  }
  const double settled = GreyOf(config, exposures.back(), 8);
  EXPECT_NEAR(settled / config.exposure_target_grey, 1, config.exposure_band + 0.01);
  EXPECT_GT(exposures.back().gain, 2);
}

TEST(ExposureControl, GIVEN_darkness_THEN_time_and_gain_end_at_their_limits) {
  const RenderConfig config = Controlled();
  const std::vector<Exposure> exposures = ControlExposure(config, std::vector<double>(5, 0));
  EXPECT_EQ(exposures.back().time_s, config.exposure_max_s);
  EXPECT_EQ(exposures.back().gain, config.gain_max);
}

TEST(ExposureControl, GIVEN_a_change_within_the_band_THEN_nothing_changes) {
  RenderConfig config = Controlled();
  config.exposure_band = 0.2;
  std::vector<double> scene(20, 100);
  std::fill(scene.begin() + 5, scene.end(), 90);
  const std::vector<Exposure> exposures = ControlExposure(config, scene);
  EXPECT_EQ(exposures.front().time_s, exposures.back().time_s);
}

}  // namespace
}  // namespace alidade
