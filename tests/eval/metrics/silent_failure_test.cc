#include "eval/metrics/silent_failure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace alidade {
namespace {

/// 10 Hz; the NEES and the alarm of each instant.
template <typename Nees, typename Alarmed>
std::vector<ReportedError> Instants(int count, Nees nees, Alarmed alarmed) {
  std::vector<ReportedError> instants;
  instants.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    instants.push_back({i * (kSecondNs / 10), nees(i), alarmed(i)});
  }
  return instants;
}

bool Never(int) {
  return false;
}

TEST(SilentFailure, BeginsWhereAGaussianIsBeyondFiveSigma) {
  // Chi-square with 6 degrees of freedom: P(> 39.491) = 5.733e-7 = P(|N(0, 1)| > 5).
  for (const auto& [nees, silent_s] : {std::pair(39.4, 0.0), std::pair(39.6, 9.9)}) {
    const double value = nees;
    EXPECT_NEAR(ComputeSilentFailure(Instants(
                                         100, [&](int) { return value; }, Never))
                    .silent_s,
                silent_s, 1e-9);
  }
}

TEST(SilentFailure, GivenSpansOfFiveSecondsAndLessThenOnlyTheLongerOnesCount) {
  const auto large = [](int i) { return i < 51 || (i >= 60 && i < 112) ? 1000.0 : 6.0; };  // 5.0 s and 5.1 s
  EXPECT_NEAR(ComputeSilentFailure(Instants(200, large, Never)).silent_s, 5.1, 1e-9);
}

TEST(SilentFailure, TheLongestSpanIsOneOfThoseThatCount) {
  const auto large = [](int i) { return i < 71 || (i >= 80 && i < 136) ? 1000.0 : 6.0; };  // 7.0 s and 5.5 s
  EXPECT_NEAR(ComputeSilentFailure(Instants(200, large, Never)).silent_s, 12.5, 1e-9);
  EXPECT_NEAR(ComputeSilentFailure(Instants(200, large, Never)).longest_s, 7.0, 1e-9);
  const auto brief = [](int i) { return i < 51 ? 1000.0 : 6.0; };
  EXPECT_EQ(ComputeSilentFailure(Instants(200, brief, Never)).longest_s, 0);
}

TEST(SilentFailure, GivenAnAlarmThenTheFailureIsNotSilent) {
  const auto large = [](int) { return 1000.0; };
  EXPECT_EQ(ComputeSilentFailure(Instants(100, large, [](int) { return true; })).silent_s, 0);
  // Reported after 6 s: these are silent.
  EXPECT_NEAR(ComputeSilentFailure(Instants(200, large, [](int i) { return i > 60; })).silent_s, 6.0, 1e-9);
  // An alarm every 4 s: never silent for longer than 5.
  EXPECT_EQ(ComputeSilentFailure(Instants(200, large, [](int i) { return i % 40 == 0; })).silent_s, 0);
}

TEST(SilentFailure, GivenAGapWithoutEstimatesThenASpanDoesNotReachOverIt) {
  std::vector<ReportedError> instants = Instants(
      100, [](int) { return 1000.0; }, Never);
  for (size_t i = 50; i < instants.size(); ++i) {
    instants[i].stamp_ns += 20 * kSecondNs;
  }
  EXPECT_EQ(ComputeSilentFailure(instants).silent_s, 0) << "4.9 s on either side";
}

TEST(SilentFailure, GivenAlarmsThenTheirShareInsideTheCovarianceIsThatOfAllKnownInstants) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto nees = [&](int i) { return i < 20 ? unknown : i < 40 ? 100.0 : 6.0; };
  const SilentFailure failure = ComputeSilentFailure(Instants(100, nees, [](int i) { return i < 50; }));
  EXPECT_DOUBLE_EQ(failure.alarm_inside_share, 10.0 / 80);
  EXPECT_TRUE(std::isnan(ComputeSilentFailure({}).alarm_inside_share));
}

TEST(SilentFailure, StatusesOfStatusCsvThatAreAlarms) {
  for (const char* alarm : {"degraded", "suspect", "lost"}) {
    EXPECT_TRUE(IsAlarm(alarm)) << alarm;
  }
  for (const char* none : {"ok", "local", "restarted"}) {
    EXPECT_FALSE(IsAlarm(none)) << none;
  }
}

}  // namespace
}  // namespace alidade
