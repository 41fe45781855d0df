#include "eval/run/imu_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/run/imu_stream.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kRateHz = 200;

/// A vehicle in motion whose frame vibrates: steps of up to 0.1 rad/s and 6 m/s^2 from sample to sample,
/// times `vibration`.
std::vector<ImuSample> Flight(int count, unsigned seed, double vibration = 1) {
  RandomStream gyro(seed, "gyro"), accel(seed, "accel");
  std::vector<ImuSample> samples;
  for (int k = 0; k < count; ++k) {
    const double t = k / kRateHz;
    samples.push_back({SecondsToNs(t), Vector3d(0.8 * std::sin(3 * t), 0.2, -0.5 * std::cos(2 * t)),
                       Vector3d(3 * std::sin(4 * t), 2 * std::cos(5 * t), 9.81)});
    samples.back().gyro += 0.03 * vibration * gyro.Normal3();
    samples.back().accel += 1.5 * vibration * accel.Normal3();
  }
  return samples;
}

/// As delivered to frames every `stride` samples; `faults` counts.
std::vector<ImuSample> Delivered(const std::vector<ImuSample>& samples, size_t stride, int* faults) {
  ImuStream stream(true);
  for (const ImuSample& sample : samples) {
    EXPECT_EQ(stream.Add(sample), ImuStream::Arrival::kTaken);
  }
  std::vector<ImuSample> delivered;
  for (size_t k = 0; k < samples.size(); k += stride) {
    while (const ImuSample* sample = stream.Deliver(samples[k].stamp_ns)) {
      delivered.push_back(*sample);
      *faults += stream.fault().empty() ? 0 : 1;
    }
  }
  return delivered;
}

double LargestError(const std::vector<ImuSample>& used, const std::vector<ImuSample>& clean) {
  double largest = 0;
  for (size_t k = 0; k < used.size(); ++k) {
    largest = std::max(
        largest, (used[k].accel - clean[k].accel).norm() / 9.81 + (used[k].gyro - clean[k].gyro).norm());
  }
  return largest;
}

TEST(ImuGuardTest, MotionAndVibrationPassUntouched) {
  const std::vector<ImuSample> clean = Flight(20000, 1);
  int faults = 0;
  const std::vector<ImuSample> used = Delivered(clean, 10, &faults);
  EXPECT_EQ(faults, 0);
  for (size_t k = 0; k < used.size(); ++k) {
    ASSERT_EQ(used[k].accel, clean[k].accel);
    ASSERT_EQ(used[k].gyro, clean[k].gyro);
  }
}

// GIVEN a spike at any place of the interval between two frames, its end included, WHEN the samples are
// delivered, THEN it is reported once and what is used is near what was measured around it.
TEST(ImuGuardTest, ASpikeIsReplacedWhereverItLies) {
  const std::vector<ImuSample> clean = Flight(1000, 2);
  for (size_t at = 500; at < 512; ++at) {
    for (const bool of_gyro : {false, true}) {
      std::vector<ImuSample> samples = clean;
      (of_gyro ? samples[at].gyro : samples[at].accel) += Vector3d(0, of_gyro ? -30 : 490, 0);
      int faults = 0;
      const std::vector<ImuSample> used = Delivered(samples, 10, &faults);
      EXPECT_EQ(faults, 1) << at;
      EXPECT_LT(LargestError(used, clean), 1.2) << at;
    }
  }
}

TEST(ImuGuardTest, AStepThatLastsIsMotionAfterOneSample) {
  std::vector<ImuSample> samples = Flight(1000, 3);
  for (size_t k = 510; k < samples.size(); ++k) {  // a frame's sample is the first
    samples[k].accel.x() += 100;
  }
  int faults = 0;
  const std::vector<ImuSample> used = Delivered(samples, 10, &faults);
  EXPECT_EQ(faults, 1);
  for (size_t k = 511; k < used.size(); ++k) {
    ASSERT_EQ(used[k].accel, samples[k].accel) << k;
  }
}

TEST(ImuGuardTest, NamesTheSensorThatJumpedAndByHowMuch) {
  ImuGuard guard;
  for (int k = 0; k < 200; ++k) {
    ImuSample sample{SecondsToNs(k / kRateHz), Vector3d::Zero(), Vector3d(0, 0, 9.81)};
    ImuSample next = sample;
    next.stamp_ns += SecondsToNs(1 / kRateHz);
    sample.gyro.z() = k == 150 ? 2 : 0;
    const std::string fault = guard.Mend(&next, &sample);
    EXPECT_EQ(fault.empty(), k != 150);
    EXPECT_EQ(sample.gyro.z(), 0);
    if (k == 150) {
      EXPECT_THAT(fault, HasSubstr("gyroscope jumps by 2 rad/s"));
    }
  }
}

/// Samples in another unit from sample `at` on.
std::vector<ImuSample> InDegreesFrom(size_t at, std::vector<ImuSample> samples) {
  for (size_t k = at; k < samples.size(); ++k) {
    samples[k].gyro *= 180 / M_PI;
  }
  return samples;
}

// GIVEN a gyroscope that changes to deg/s at any place of the interval between two frames, and back, WHEN the
// samples are delivered, THEN each change is reported once, and all of them are in rad/s.
TEST(ImuGuardTest, AGyroscopeThatChangesItsUnitIsConverted) {
  const std::vector<ImuSample> clean = Flight(1000, 4, 0.1);
  for (size_t at = 500; at < 512; ++at) {
    std::vector<ImuSample> samples = InDegreesFrom(at, clean);
    std::copy(clean.begin() + 800, clean.end(), samples.begin() + 800);
    int faults = 0;
    const std::vector<ImuSample> used = Delivered(samples, 10, &faults);
    EXPECT_EQ(faults, 2) << at;
    EXPECT_LT(LargestError(used, clean), 1e-12) << at;
  }
}

TEST(ImuGuardTest, ARateThatGrowsInAnotherDirectionIsNoChangeOfUnit) {
  std::vector<ImuSample> samples = Flight(1000, 5, 0.1);
  for (size_t k = 500; k < samples.size(); ++k) {
    samples[k].gyro = Vector3d(samples[k].gyro.z(), samples[k].gyro.x(), samples[k].gyro.y()) * 180 / M_PI;
  }
  int faults = 0;
  const std::vector<ImuSample> used = Delivered(samples, 10, &faults);
  EXPECT_EQ(used.back().gyro, samples[used.size() - 1].gyro);
}

TEST(ImuGuardTest, WhatWaitsIsInRadiansAfterAChangeOfUnit) {
  const std::vector<ImuSample> clean = Flight(600, 4, 0.1);
  ImuStream stream(true);
  for (const ImuSample& sample : InDegreesFrom(500, clean)) {
    ASSERT_EQ(stream.Add(sample), ImuStream::Arrival::kTaken);
  }
  while (stream.Deliver(clean[550].stamp_ns) != nullptr) {
  }
  EXPECT_LT((stream.newest_gyro() - clean.back().gyro).norm(), 1e-12);
  EXPECT_LT((stream.Since(clean[560].stamp_ns).back().gyro - clean.back().gyro).norm(), 1e-12);
}

/// A folder of ../shared/data: EuRoC, TUM VI, a phone and a walk, none with a faulty sample.
class ImuGuardOnRealImu : public testing::TestWithParam<const char*> {};

TEST_P(ImuGuardOnRealImu, TouchesNoSample) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Result<Dataset> dataset = ReadDataset(test::SharedDir() + "/data/" + GetParam());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  int faults = 0;
  const std::vector<ImuSample> used = Delivered(dataset->imu, 10, &faults);
  EXPECT_GT(used.size(), 1000u);
  EXPECT_EQ(faults, 0);
  for (const ImuSample& sample : used) {
    ASSERT_TRUE(sample.gyro_fault_density_radps_sqrthz.isZero(0));
    ASSERT_TRUE(sample.accel_fault_density_mps2_sqrthz.isZero(0));
  }
}

INSTANTIATE_TEST_SUITE_P(SharedData, ImuGuardOnRealImu,
                         testing::Values("euroc/MH_03_medium", "euroc/MH_05_difficult", "euroc/V1_01_easy",
                                         "euroc/V1_02_medium", "euroc/V2_01_easy", "euroc/V2_02_medium",
                                         "tumvi/room1", "tumvi/room3", "tumvi/room5",
                                         "real_images/phone_102213", "gnss_imu/walk_0827",
                                         "tracks/tango_7hz"));

}  // namespace
}  // namespace alidade
