#include "eval/run/imu_leap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace alidade {
namespace {

using Verdict = ImuLeap::Verdict;

ImuSample Stamped(double seconds) {
  ImuSample sample;
  sample.stamp_ns = SecondsToNs(seconds);
  return sample;
}

/// What is taken and refused of samples at these times, in seconds.
class ImuLeapTest : public testing::Test {
 protected:
  Verdict Add(double seconds) {
    const ImuSample sample = Stamped(seconds);
    const ImuLeap::Outcome outcome = leap_.Add(sample, newest_ns_);
    EXPECT_FALSE(outcome.confirmed && outcome.refused);
    if (outcome.refused) {
      refused_.push_back(outcome.refused->stamp_ns);
    }
    if (outcome.confirmed) {
      Take(*outcome.confirmed);
    }
    if (outcome.verdict == Verdict::kTake) {
      Take(sample);
    }
    return outcome.verdict;
  }

  /// At the end of a log.
  void Flush() {
    if (const std::optional<ImuSample> held = leap_.Release(INT64_MAX)) {
      Take(*held);
    }
  }

  static std::vector<TimeNs> At(const std::vector<double>& seconds) {
    std::vector<TimeNs> stamps;
    stamps.reserve(seconds.size());
    for (const double time : seconds) {
      stamps.push_back(SecondsToNs(time));
    }
    return stamps;
  }

  ImuLeap leap_;
  std::vector<TimeNs> taken_;
  std::vector<TimeNs> refused_;

 private:
  void Take(const ImuSample& sample) {
    taken_.push_back(sample.stamp_ns);
    newest_ns_ = std::max(newest_ns_, sample.stamp_ns);
  }

  TimeNs newest_ns_ = INT64_MIN;
};

// GIVEN a log that begins at any time and pauses for no longer than the limit THEN nothing is held.
TEST_F(ImuLeapTest, OrdinarySamplesAndTheFirstAreTakenAtOnce) {
  for (const double seconds : {1e6, 1e6 + 0.01, 1e6 + 0.02, 1e6 + 1.02}) {
    EXPECT_EQ(Add(seconds), Verdict::kTake) << seconds;
    EXPECT_FALSE(leap_.holds());
  }
  EXPECT_EQ(Add(1e6 + 2.03), Verdict::kHold);
  EXPECT_TRUE(leap_.holds());
}

// GIVEN one stamp an hour ahead THEN it alone is refused, and the ordinary sample after it is taken.
TEST_F(ImuLeapTest, ALoneLeapIsRefused) {
  Add(0);
  EXPECT_EQ(Add(3600), Verdict::kHold);
  EXPECT_EQ(Add(0.01), Verdict::kTake);
  EXPECT_FALSE(leap_.holds());
  EXPECT_EQ(Add(0.02), Verdict::kTake);
  EXPECT_EQ(taken_, At({0, 0.01, 0.02}));
  EXPECT_EQ(refused_, At({3600}));
}

// GIVEN an IMU that was silent for a while THEN nothing of it is lost, and the order stays.
TEST_F(ImuLeapTest, ALeapThatTheNextSampleConfirmsIsTakenBeforeIt) {
  Add(0);
  EXPECT_EQ(Add(5), Verdict::kHold);
  EXPECT_EQ(Add(5.01), Verdict::kTake);
  EXPECT_EQ(Add(5.02), Verdict::kTake);
  EXPECT_EQ(taken_, At({0, 5, 5.01, 5.02}));
  EXPECT_TRUE(refused_.empty());
}

TEST_F(ImuLeapTest, WhatIsHeldIsTheWholeSample) {
  ImuSample leap = Stamped(5);
  leap.gyro = {0.1, 0.2, 0.3};
  leap.accel = {1, 2, 9};
  EXPECT_EQ(leap_.Add(leap, 0).verdict, Verdict::kHold);
  const ImuLeap::Outcome outcome = leap_.Add(Stamped(5.01), 0);
  ASSERT_TRUE(outcome.confirmed);
  EXPECT_EQ(outcome.confirmed->gyro, leap.gyro);
  EXPECT_EQ(outcome.confirmed->accel, leap.accel);
}

// GIVEN two wrong stamps in a row, each far from the other, THEN neither confirms the other.
TEST_F(ImuLeapTest, ALeapOverALeapRefusesTheFirstAndIsHeld) {
  Add(0);
  Add(3600);
  EXPECT_EQ(Add(7200), Verdict::kHold);
  EXPECT_EQ(refused_, At({3600}));
  EXPECT_EQ(Add(0.01), Verdict::kTake);
  EXPECT_EQ(taken_, At({0, 0.01}));
  EXPECT_EQ(refused_, At({3600, 7200}));
}

// GIVEN a second leap that lies before the first THEN it does not confirm it: time steps back there.
TEST_F(ImuLeapTest, ALeapThatStepsBackConfirmsNothing) {
  Add(0);
  Add(5);
  EXPECT_EQ(Add(4.99), Verdict::kHold);
  EXPECT_EQ(refused_, At({5}));
  EXPECT_EQ(Add(5), Verdict::kTake);
  EXPECT_EQ(taken_, At({0, 4.99, 5}));
}

TEST_F(ImuLeapTest, AStepBackIsNoLeap) {
  Add(100);
  EXPECT_EQ(Add(0), Verdict::kTake);
  EXPECT_FALSE(leap_.holds());
}

// GIVEN the leap once more THEN one copy is still held: a repeated message confirms nothing.
TEST_F(ImuLeapTest, TheSameStampAgainConfirmsNothing) {
  Add(0);
  Add(5);
  EXPECT_EQ(Add(5), Verdict::kTwice);
  EXPECT_TRUE(leap_.holds());
  EXPECT_EQ(Add(5.01), Verdict::kTake);
  EXPECT_EQ(taken_, At({0, 5, 5.01}));
  EXPECT_TRUE(refused_.empty());
}

TEST_F(ImuLeapTest, TheEndOfTheLogReleasesWhatIsHeld) {
  Add(0);
  Add(5);
  Flush();
  EXPECT_FALSE(leap_.holds());
  EXPECT_EQ(taken_, At({0, 5}));
  Flush();
  EXPECT_EQ(taken_, At({0, 5})) << "once";
}

// GIVEN that messages up to a time are awaited no more THEN a leap beyond it stays held.
TEST_F(ImuLeapTest, IsReleasedWhenItsTimeHasCome) {
  Add(0);
  Add(5);
  EXPECT_FALSE(leap_.Release(SecondsToNs(5) - 1));
  EXPECT_TRUE(leap_.holds());
  EXPECT_TRUE(leap_.Release(SecondsToNs(5)));
  EXPECT_FALSE(leap_.holds());
}

}  // namespace
}  // namespace alidade
