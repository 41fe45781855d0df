#include "core/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace alidade {
namespace {

TEST(RandomStreamTest, SameSeedAndPurposeGiveTheSameNumbers) {
  RandomStream first(7, "a");
  RandomStream second(7, "a");
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(first.Normal(), second.Normal());
  }
}

TEST(RandomStreamTest, SeedAndPurposeBothChangeTheNumbers) {
  EXPECT_NE(RandomStream(7, "a").Uniform(), RandomStream(8, "a").Uniform());
  EXPECT_NE(RandomStream(7, "a").Uniform(), RandomStream(7, "b").Uniform());
}

TEST(RandomStreamTest, EngineFollowsTheStandard) {
  // [rand.predef]: the 10000th output of a default-constructed mt19937_64; the engine is what makes bytes
  // portable.
  std::mt19937_64 engine;
  engine.discard(9999);
  EXPECT_EQ(engine(), 9981545732273789042ULL);
}

TEST(RandomStreamTest, NormalHasStandardMoments) {
  RandomStream stream(1, "moments");
  constexpr int kCount = 200000;
  double sum = 0;
  double sum2 = 0;
  double sum4 = 0;
  double lag = 0;
  double previous = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = stream.Normal();
    sum += x;
    sum2 += x * x;
    sum4 += x * x * x * x;
    lag += x * previous;
    previous = x;
  }
  // Standard deviations of the estimates: 1, sqrt(2), sqrt(96) and 1 over sqrt(n); four of them allowed.
  const double root = std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(sum / kCount, 0, 4 / root);
  EXPECT_NEAR(sum2 / kCount, 1, 4 * std::sqrt(2.0) / root);
  EXPECT_NEAR(sum4 / kCount, 3, 4 * std::sqrt(96.0) / root);
  EXPECT_NEAR(lag / kCount, 0, 4 / root);
}

TEST(RandomStreamTest, BelowIsUniformAndInRange) {
  RandomStream stream(1, "below");
  std::vector<int> counts(7, 0);
  for (int i = 0; i < 70000; ++i) {
    const std::uint64_t draw = stream.Below(7);
    ASSERT_LT(draw, 7u);
    ++counts[static_cast<std::size_t>(draw)];
  }
  for (const int count : counts) {
    EXPECT_NEAR(count, 10000, 4 * std::sqrt(10000 * 6.0 / 7));
  }
}

TEST(RandomStreamTest, ShuffleKeepsElementsAndMovesThem) {
  std::vector<int> values(100);
  std::iota(values.begin(), values.end(), 0);
  const std::vector<int> sorted = values;
  RandomStream stream(1, "shuffle");
  stream.Shuffle(&values);
  EXPECT_NE(values, sorted);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(values, sorted);
}

}  // namespace
}  // namespace alidade
