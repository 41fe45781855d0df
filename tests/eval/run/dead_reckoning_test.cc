#include "eval/run/dead_reckoning.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace alidade {
namespace {

constexpr TimeNs kStepNs = 5'000'000;

std::vector<ImuSample> Samples(int count) {
  RandomStream random(1, "samples");
  std::vector<ImuSample> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    samples.push_back(
        {i * kStepNs, 0.2 * random.Normal3(), Eigen::Vector3d(0, 0, 9.81) + 0.5 * random.Normal3()});
  }
  return samples;
}

NavEstimate Start(TimeNs stamp_ns) {
  NavEstimate start;
  start.stamp_ns = stamp_ns;
  start.nav.v_WB = {1, 2, 3};
  start.bias.gyro = {0.01, 0, 0};
  start.covariance = 1e-4 * Matrix15d::Identity();
  return start;
}

/// Over the whole interval at once.
NavEstimate ByHand(const NavEstimate& start, const std::vector<ImuSample>& samples, TimeNs stamp_ns) {
  ImuBuffer buffer(1);
  for (const ImuSample& sample : samples) {
    EXPECT_TRUE(buffer.Add(sample).ok());
  }
  std::vector<ImuSample> interval;
  EXPECT_TRUE(buffer.Interval(start.stamp_ns, stamp_ns, &interval).ok());
  NavEstimate end = start;
  EXPECT_TRUE(PropagateEstimate(interval, ImuNoise(), GravityInWorld(9.81), &end).ok());
  return end;
}

// GIVEN far more samples than are held, WHEN the state at the end is asked for, THEN it is that of one
// propagation over all of them, bit by bit.
TEST(DeadReckoningTest, HoweverLongItEqualsOnePropagation) {
  const std::vector<ImuSample> samples = Samples(7000);
  const NavEstimate start = Start(12 * kStepNs + 3'000'000);
  DeadReckoning reckoning(ImuNoise(), 9.81, 1);
  size_t next = 0;
  for (; next < 14; ++next) {
    reckoning.AddImu(samples[next]);
  }
  reckoning.Reset(start);
  for (; next < samples.size(); ++next) {
    reckoning.AddImu(samples[next]);
  }
  for (const TimeNs stamp : {6998 * kStepNs + 1'000'000, 6999 * kStepNs}) {
    const std::optional<NavEstimate> end = reckoning.At(stamp);
    ASSERT_TRUE(end);
    const NavEstimate expected = ByHand(start, samples, stamp);
    EXPECT_EQ(end->stamp_ns, stamp);
    EXPECT_EQ(end->nav.p_WB, expected.nav.p_WB);
    EXPECT_EQ(end->nav.R_WB, expected.nav.R_WB);
    EXPECT_EQ(end->covariance, expected.covariance);
  }
  EXPECT_GT(reckoning.Here().stamp_ns, 5000 * kStepNs);
}

TEST(DeadReckoningTest, IsEmptyBeyondTheSamples) {
  DeadReckoning reckoning(ImuNoise(), 9.81, 1);
  for (const ImuSample& sample : Samples(10)) {
    reckoning.AddImu(sample);
  }
  reckoning.Reset(Start(2 * kStepNs));
  EXPECT_TRUE(reckoning.At(9 * kStepNs));
  EXPECT_FALSE(reckoning.At(9 * kStepNs + 1));
  EXPECT_EQ(reckoning.At(2 * kStepNs)->nav.v_WB, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace alidade
