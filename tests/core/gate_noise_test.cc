#include "core/gate_noise.h"

#include <gtest/gtest.h>

#include <random>

namespace alidade {
namespace {

constexpr double kGivenPx = 0.5;
constexpr double kFrameSeconds = 0.05;

VisionConfig Adaptive() {
  VisionConfig config;
  config.pixel_noise_px = kGivenPx;
  config.gate_noise = GateNoiseModel::kAdaptive;
  return config;
}

/// Frames of tracks with 5 or 2 degrees of freedom, of which `sliding` have a hundred times the variance.
class Frames {
 public:
  explicit Frames(const VisionConfig& config) : noise_(config) {}

  /// The deviation at the gate, over the given one, after `duration_s` of tracks whose deviation is
  /// `deviation` times what is given.
  double After(double duration_s, double deviation, double sliding = 0, int tracks = 100) {
    std::bernoulli_distribution slides(sliding);
    std::normal_distribution<double> normal;
    for (int frame = 0; frame * kFrameSeconds < duration_s; ++frame) {
      for (int track = 0; track < tracks; ++track) {
        const int dof = track % 2 == 0 ? 5 : 2;
        double squares = 0;
        for (int row = 0; row < dof; ++row) {
          const double value = normal(random_);
          squares += value * value;
        }
        const double variance = deviation * deviation * (slides(random_) ? 100 : 1);
        noise_.AddTrack(squares * variance / noise_.variance(), dof);
      }
      noise_.EndFrame(stamp_ns_ += SecondsToNs(kFrameSeconds));
    }
    return std::sqrt(noise_.variance());
  }
  GateNoise& noise() { return noise_; }

 private:
  GateNoise noise_;
  std::mt19937 random_{5};
  TimeNs stamp_ns_ = kSecondNs;
};

TEST(GateNoiseTest, GivenTracksOfTheGivenNoiseOrMoreThenTheGateStays) {
  Frames frames(Adaptive());
  EXPECT_EQ(frames.After(60, 1), 1);
  EXPECT_EQ(frames.After(60, 3), 1);
  EXPECT_EQ(frames.After(60, 0.85), 1) << "within the margin";
}

TEST(GateNoiseTest, GivenTracksOfLessNoiseThenTheGateIsAQuarterAboveThem) {
  Frames frames(Adaptive());
  EXPECT_NEAR(frames.After(20, 0.3), 1.25 * 0.3, 0.02);
  EXPECT_NEAR(frames.After(20, 0.6), 1.25 * 0.6, 0.03) << "and follows them up again";
  EXPECT_NEAR(frames.After(20, 0.3, 0, 6), 1.25 * 0.3, 0.03) << "sets of several frames";
}

TEST(GateNoiseTest, AQuarterOfTheTracksMaySlide) {
  Frames frames(Adaptive());
  EXPECT_NEAR(frames.After(20, 0.3, 0.25), 1.25 * 0.3, 0.1);
}

TEST(GateNoiseTest, ItIsNeverBelowWhatInterpolationLeaves) {
  Frames frames(Adaptive());
  EXPECT_NEAR(frames.After(60, 1e-3), 1.25 * 0.05 / kGivenPx, 1e-6);
  VisionConfig fine = Adaptive();
  fine.pixel_noise_px = 0.04;
  EXPECT_EQ(Frames(fine).After(60, 1e-3), 1);
}

TEST(GateNoiseTest, AGivenOneStaysAndResetForgets) {
  VisionConfig given = Adaptive();
  given.gate_noise = GateNoiseModel::kGiven;
  EXPECT_EQ(Frames(given).After(60, 0.1), 1);
  Frames frames(Adaptive());
  EXPECT_LT(frames.After(20, 0.2), 0.3);
  EXPECT_TRUE(frames.noise().lowered());
  frames.noise().Reset();
  EXPECT_FALSE(frames.noise().lowered());
  EXPECT_EQ(frames.noise().variance(), 1);
}

}  // namespace
}  // namespace alidade
