#include "eval/metrics/completion.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

std::vector<TimeNs> Milliseconds(const std::vector<TimeNs>& stamps_ms) {
  std::vector<TimeNs> stamps_ns;
  stamps_ns.reserve(stamps_ms.size());
  for (const TimeNs stamp_ms : stamps_ms) {
    stamps_ns.push_back(stamp_ms * 1'000'000);
  }
  return stamps_ns;
}

TEST(Completion, GivenAGapThenItIsNotCovered) {
  // 3.0 to 4.0 s, then nothing until 8 s.
  const std::vector<TimeNs> rows = Milliseconds({3000, 3250, 3500, 4000, 8000});
  EXPECT_DOUBLE_EQ(CoveredSeconds(rows), 1);
  EXPECT_DOUBLE_EQ(*Completion(rows, kSecondNs, 11 * kSecondNs), 0.1);
}

TEST(Completion, GivenRowsAtMostHalfASecondApartThenTheyCoverTheTimeBetween) {
  EXPECT_DOUBLE_EQ(*Completion(Milliseconds({0, 500, 1000}), 0, kSecondNs), 1);
  EXPECT_DOUBLE_EQ(*Completion({0, kSecondNs / 2 + 1, kSecondNs}, 0, kSecondNs), 0.499999999);
}

TEST(Completion, GivenRowsBeforeAndAfterTheFramesThenTheyAreNotCounted) {
  const std::vector<TimeNs> rows = Milliseconds({0, 400, 800, 1200, 1600, 2000, 2400});
  EXPECT_DOUBLE_EQ(*Completion(rows, kSecondNs, 2 * kSecondNs), 1);
}

TEST(Completion, GivenNoRowOrOneThenItIsZero) {
  EXPECT_EQ(Completion({}, 0, kSecondNs), 0.0);
  EXPECT_EQ(Completion({kSecondNs / 2}, 0, kSecondNs), 0.0);
  EXPECT_EQ(CoveredSeconds({}), 0.0);
}

TEST(Completion, GivenNoTimeBetweenTheFramesThenItIsUnknown) {
  EXPECT_FALSE(Completion(Milliseconds({0, 100}), 0, 0).has_value());
}

}  // namespace
}  // namespace alidade
