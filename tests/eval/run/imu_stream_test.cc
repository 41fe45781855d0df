#include "eval/run/imu_stream.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

ImuSample At(TimeNs stamp_ns) {
  return {stamp_ns, Eigen::Vector3d(1e-3 * static_cast<double>(stamp_ns), 0, 0), Eigen::Vector3d::Zero()};
}

TEST(ImuStreamTest, DeliversInTheOrderOfStampsUpToTheFirstSampleAtOrAfter) {
  ImuStream stream(false);
  for (const TimeNs stamp : {10, 30, 20, 50, 40}) {
    EXPECT_EQ(stream.Add(At(stamp)), ImuStream::Arrival::kTaken);
  }
  std::vector<TimeNs> delivered;
  while (const ImuSample* sample = stream.Deliver(25)) {
    delivered.push_back(sample->stamp_ns);
  }
  EXPECT_EQ(delivered, (std::vector<TimeNs>{10, 20, 30}));
  EXPECT_EQ(stream.Deliver(30), nullptr);
  EXPECT_EQ(stream.newest_ns(), 50);
  EXPECT_EQ(stream.newest_gyro().x(), 0.05);
  EXPECT_EQ(stream.FirstAtOrAfter(31), std::optional<TimeNs>(40));
  EXPECT_FALSE(stream.FirstAtOrAfter(51));
}

TEST(ImuStreamTest, RefusesWhatIsThereAndWhatIsNotAfterTheDelivered) {
  ImuStream stream(false);
  ASSERT_EQ(stream.Add(At(10)), ImuStream::Arrival::kTaken);
  EXPECT_EQ(stream.Add(At(10)), ImuStream::Arrival::kTwice);
  ASSERT_EQ(stream.Add(At(30)), ImuStream::Arrival::kTaken);
  ASSERT_NE(stream.Deliver(10), nullptr);
  EXPECT_EQ(stream.Add(At(10)), ImuStream::Arrival::kTooLate);
  EXPECT_EQ(stream.Add(At(5)), ImuStream::Arrival::kTooLate);
  EXPECT_EQ(stream.Add(At(11)), ImuStream::Arrival::kTaken);
}

TEST(ImuStreamTest, ForgetsDeliveredSamplesButTheLastTwoNotAfter) {
  ImuStream stream(false);
  for (TimeNs stamp = 10; stamp <= 60; stamp += 10) {
    ASSERT_EQ(stream.Add(At(stamp)), ImuStream::Arrival::kTaken);
  }
  while (stream.Deliver(40) != nullptr) {
  }
  stream.DropBefore(35);
  ASSERT_EQ(stream.size(), 5u);  // 20, 30, 40 and the two that are not delivered
  EXPECT_EQ(stream.DeliveredSince(35).front().stamp_ns, 20);
  EXPECT_EQ(stream.DeliveredSince(35).back().stamp_ns, 40);
  EXPECT_EQ(stream.Since(35).back().stamp_ns, 60);
  stream.DropBefore(1000);
  EXPECT_EQ(stream.size(), 4u);
}

/// A hundred samples a second, of which those from 300 to `end_ms` are missing.
ImuStream WithSilence(TimeNs end_ms) {
  ImuStream stream(false);
  for (TimeNs ms = 0; ms <= end_ms + 100; ms += 10) {
    if (ms < 300 || ms >= end_ms) {
      stream.Add(At(ms * 1'000'000));
    }
  }
  return stream;
}

TEST(ImuStreamTest, FindsASilenceThatBeginsBeforeTheStamp) {
  constexpr TimeNs kMs = 1'000'000;
  const ImuStream stream = WithSilence(700);
  EXPECT_FALSE(stream.FirstSilence(INT64_MIN, 290 * kMs));
  const std::optional<ImuSilence> silence = stream.FirstSilence(INT64_MIN, 291 * kMs);
  ASSERT_TRUE(silence);
  EXPECT_EQ(silence->begin_ns, 290 * kMs);
  EXPECT_EQ(silence->end_ns, 700 * kMs);
  EXPECT_EQ(silence->excess_ns, 400 * kMs);
  EXPECT_FALSE(stream.FirstSilence(700 * kMs, 800 * kMs));
  EXPECT_FALSE(WithSilence(380).FirstSilence(INT64_MIN, 400 * kMs));   // steps of up to 0.1 s are usual
  EXPECT_FALSE(WithSilence(2400).FirstSilence(INT64_MIN, 400 * kMs));  // longer than is questioned
}

TEST(ImuStreamTest, ASilenceWhoseEndWasDeliveredIsNotFound) {
  constexpr TimeNs kMs = 1'000'000;
  ImuStream stream = WithSilence(700);
  while (stream.Deliver(300 * kMs) != nullptr) {
  }
  ASSERT_EQ(stream.delivered_ns(), 700 * kMs);
  EXPECT_FALSE(stream.FirstSilence(INT64_MIN, 800 * kMs));
}

TEST(ImuStreamTest, AJumpIsTakenOffTheLaterStamps) {
  constexpr TimeNs kMs = 1'000'000;
  ImuStream stream = WithSilence(700);
  stream.TakeBack(*stream.FirstSilence(INT64_MIN, 400 * kMs));
  EXPECT_EQ(stream.newest_ns(), 400 * kMs);
  EXPECT_EQ(stream.FirstAtOrAfter(291 * kMs), std::optional<TimeNs>(300 * kMs));
  EXPECT_FALSE(stream.FirstSilence(INT64_MIN, 500 * kMs));
  EXPECT_EQ(stream.Add(At(410 * kMs)), ImuStream::Arrival::kTaken);
}

TEST(ImuStreamTest, PassesOverSamplesThatNobodyAskedFor) {
  ImuStream stream(false);
  for (TimeNs stamp = 10; stamp <= 40; stamp += 10) {
    ASSERT_EQ(stream.Add(At(stamp)), ImuStream::Arrival::kTaken);
  }
  EXPECT_EQ(stream.PassOver(25)->stamp_ns, 10);
  EXPECT_EQ(stream.PassOver(25)->stamp_ns, 20);
  EXPECT_FALSE(stream.PassOver(25));
  EXPECT_EQ(stream.Add(At(15)), ImuStream::Arrival::kTooLate);
  EXPECT_EQ(stream.Deliver(30)->stamp_ns, 30);
}

}  // namespace
}  // namespace alidade
