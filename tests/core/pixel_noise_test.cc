#include "core/pixel_noise.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

constexpr double kGivenPx = 0.7;
constexpr double kFrameSeconds = 0.05;

VisionConfig Adaptive() {
  VisionConfig config;
  config.pixel_noise_px = kGivenPx;
  config.noise = PixelNoiseModel::kAdaptive;
  return config;
}

/// Frames of 100 tracks whose deviation is `deviation` times what is given.
class Frames {
 public:
  explicit Frames(const VisionConfig& config) : noise_(config) {}

  double After(double duration_s, double deviation, bool suspect = false) {
    for (int frame = 0; frame * kFrameSeconds < duration_s; ++frame) {
      const double assumed = noise_.px() / kGivenPx;
      for (int track = 0; track < 100; ++track) {
        noise_.AddTrack(2 * deviation * deviation / (assumed * assumed), 2);
      }
      noise_.EndFrame(stamp_ns_ += SecondsToNs(kFrameSeconds), suspect);
    }
    return noise_.px() / kGivenPx;
  }
  PixelNoise& noise() { return noise_; }

 private:
  PixelNoise noise_;
  TimeNs stamp_ns_ = kSecondNs;
};

TEST(PixelNoiseTest, GivenInnovationsAsPredictedThenTheNoiseStays) {
  Frames frames(Adaptive());
  EXPECT_EQ(frames.After(100, 1), 1);
}

TEST(PixelNoiseTest, GivenTracksOfTwiceTheNoiseThenItIsFoundAndForgottenAgain) {
  Frames frames(Adaptive());
  EXPECT_NEAR(frames.After(20, 2), 1.2, 0.03) << "at most 1 % a second";
  EXPECT_NEAR(frames.After(300, 2), 2, 0.01);
  EXPECT_NEAR(frames.After(300, 0.5), 1, 1e-9) << "never less than given";
}

TEST(PixelNoiseTest, GivenFiveSecondsOfAFaultThenTheNoiseHardlyMoves) {
  Frames frames(Adaptive());
  frames.After(30, 1);
  EXPECT_LT(frames.After(5, 3), 1.06) << "five seconds of three times the deviation";
  EXPECT_LT(frames.After(30, 1), 1.25) << "the window remembers it";
  EXPECT_NEAR(frames.After(200, 1), 1, 0.01);
}

TEST(PixelNoiseTest, SuspectFramesAndFewTracksDoNotCount) {
  Frames frames(Adaptive());
  EXPECT_EQ(frames.After(50, 3, true), 1);
  for (int k = 1; k < 1000; ++k) {
    frames.noise().AddTrack(100, 9);
    frames.noise().EndFrame(100 * kSecondNs + k * kSecondNs / 20, false);
  }
  EXPECT_EQ(frames.noise().px(), kGivenPx);
}

TEST(PixelNoiseTest, AGivenNoiseStaysAndResetForgets) {
  VisionConfig given = Adaptive();
  given.noise = PixelNoiseModel::kGiven;
  Frames fixed(given);
  EXPECT_EQ(fixed.After(50, 3), 1);
  Frames frames(Adaptive());
  EXPECT_GT(frames.After(50, 3), 1.3);
  frames.noise().Reset();
  EXPECT_EQ(frames.noise().px(), kGivenPx);
}

}  // namespace
}  // namespace alidade
