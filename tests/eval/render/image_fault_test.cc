#include "eval/render/image_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/render/rendered_scene.h"

namespace alidade {
namespace {

using test::MeanGrey;
using test::Scene;
using test::Sharpness;

constexpr std::size_t kBefore = 7;  // of 20 a second; the fault lasts from image 8 to 13
constexpr std::size_t kFirst = 8;
constexpr std::size_t kLast = 13;
constexpr std::size_t kAfter = 14;

SimulatorConfig Faulty(SimFaultKind fault) {
  SimulatorConfig config = test::SmallConfig();
  config.fault = fault;
  config.fault_start_s = 0.39;
  config.fault_duration_s = 0.3;
  return config;
}

RenderedSequence Images(SimFaultKind fault) {
  return Scene::Make(Faulty(fault)).sequence;
}

TEST(ImageFaultTest, ImagesBeforeAndAfterAreThoseWithoutTheFault) {
  const RenderedSequence clean = Images(SimFaultKind::kNone);
  for (const SimFaultKind fault :
       {SimFaultKind::kBlackout, SimFaultKind::kGlare, SimFaultKind::kBlur, SimFaultKind::kFrozen}) {
    const RenderedSequence faulty = Images(fault);
    EXPECT_EQ(faulty.Frame(kBefore).pixels, clean.Frame(kBefore).pixels);
    EXPECT_EQ(faulty.Frame(kAfter).pixels, clean.Frame(kAfter).pixels);
    EXPECT_NE(faulty.Frame(kLast).pixels, clean.Frame(kLast).pixels);
  }
}

TEST(ImageFaultTest, ACoveredLensLeavesTheNoiseOfTheSensorAndGlareLeavesNothing) {
  const RenderedSequence dark = Images(SimFaultKind::kBlackout);
  EXPECT_LT(MeanGrey(dark.Frame(kFirst)), 2);
  EXPECT_GT(Sharpness(dark.Frame(kFirst)), 0.1);
  EXPECT_GT(MeanGrey(Images(SimFaultKind::kGlare).Frame(kLast)), 250);
}

TEST(ImageFaultTest, ABlurredImageHasItsMeanAndNoDetail) {
  SimulatorConfig config = Faulty(SimFaultKind::kBlur);
  config.render.read_noise_grey = 0;
  config.render.shot_noise_grey = 0;
  const RenderedSequence blurred = Scene::Make(config).sequence;
  config.fault = SimFaultKind::kNone;
  const RenderedSequence sharp = Scene::Make(config).sequence;
  EXPECT_NEAR(MeanGrey(blurred.Frame(kFirst)), MeanGrey(sharp.Frame(kFirst)), 2);
  EXPECT_LT(Sharpness(blurred.Frame(kFirst)), 0.1 * Sharpness(sharp.Frame(kFirst)));
}

TEST(ImageFaultTest, AFrozenCameraRepeatsItsImageBitByBit) {
  const RenderedSequence frozen = Images(SimFaultKind::kFrozen);
  EXPECT_EQ(frozen.Frame(kFirst).pixels, Images(SimFaultKind::kNone).Frame(kFirst).pixels);
  EXPECT_EQ(frozen.Frame(kLast).pixels, frozen.Frame(kFirst).pixels);
}

TEST(ImageFaultTest, DroppedImagesHaveNoStamp) {
  SimulatorConfig config = Faulty(SimFaultKind::kFrameDrops);
  config.fault_drop_rate = 1;
  EXPECT_EQ(Images(SimFaultKind::kNone).stamps().size() - Scene::Make(config).sequence.stamps().size(),
            kLast - kFirst + 1);
}

TEST(ImageFaultTest, ExposureControlReactsToTheLight) {
  SimulatorConfig config = Faulty(SimFaultKind::kBlackout);
  config.render.auto_exposure = true;
  const Scene scene = Scene::Make(config);
  const std::vector<Exposure>& exposures = scene.sequence.exposures();
  EXPECT_GT(exposures[kAfter].time_s * exposures[kAfter].gain,
            2 * exposures[kBefore].time_s * exposures[kBefore].gain);
}

TEST(ImageFaultTest, FaultsThatTheImagesCannotHaveAreRefused) {
  for (const SimFaultKind fault : {SimFaultKind::kTracks, SimFaultKind::kCameraClock}) {
    EXPECT_THAT(Faulty(fault).Validate().message(), testing::HasSubstr("render.enabled: false"));
  }
  SimulatorConfig tracks = Faulty(SimFaultKind::kBlur);
  tracks.render.enabled = false;
  EXPECT_THAT(tracks.Validate().message(), testing::HasSubstr("expected render.enabled: true"));
}

}  // namespace
}  // namespace alidade
