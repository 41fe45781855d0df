#include "eval/peers/gvins_pairing.h"

#include <gtest/gtest.h>

#include <string>

namespace alidade {
namespace {

/// "3:1" frame 3 with epoch 1, "5:-" frame 5 alone.
std::string Next(GvinsPairing* pairing) {
  std::string text;
  while (const auto pair = pairing->Next()) {
    text += (text.empty() ? "" : " ") + std::to_string(pair->frame) + ":" +
            (pair->epoch ? std::to_string(*pair->epoch) : "-");
  }
  return text;
}

TEST(GvinsPairing, WithoutGnssEverySecondFrameGoesOnAtOnce) {
  GvinsPairing pairing(false);
  for (size_t frame = 0; frame < 5; ++frame) {
    pairing.AddFrame(0.05 * static_cast<double>(frame), frame);
  }
  EXPECT_EQ(Next(&pairing), "0:- 2:- 4:-");
}

// Epochs at 0.10, 0.20, ..., frames every 0.05 s at `shift` beside them.
std::string TenHertz(double shift_s) {
  GvinsPairing pairing(true);
  std::string text;
  size_t epoch = 0;
  for (size_t frame = 1; frame < 10; ++frame) {
    const double time_s = 0.05 * static_cast<double>(frame) + shift_s;
    while (0.1 * static_cast<double>(epoch + 1) <= time_s) {
      pairing.AddEpoch(0.1 * static_cast<double>(epoch + 1), epoch);
      ++epoch;
    }
    pairing.AddFrame(time_s, frame);
    const std::string next = Next(&pairing);
    text += next.empty() ? "" : next + " ";
  }
  return text;
}

TEST(GvinsPairing, TakesTheFramesThatAreNearerToTheEpochs) {
  EXPECT_EQ(TenHertz(0.01), "2:0 4:1 6:2 8:3 ") << "those 0.01 s after an epoch";
  EXPECT_EQ(TenHertz(-0.04), "3:0 5:1 7:2 9:3 ") << "the other half";
}

TEST(GvinsPairing, WhileNoEpochWaitsNoFrameGoesOn) {
  GvinsPairing pairing(true);
  pairing.AddEpoch(1, 0);
  for (size_t frame = 0; frame < 20; ++frame) {
    pairing.AddFrame(1 + 0.05 * static_cast<double>(frame), frame);
  }
  EXPECT_EQ(Next(&pairing), "") << "the epoch is older than the first frame that is taken, and dropped";
  pairing.AddEpoch(2, 1);
  EXPECT_EQ(Next(&pairing), "2:- 4:- 6:- 8:- 10:- 12:- 14:- 16:- 18:-");
}

}  // namespace
}  // namespace alidade
