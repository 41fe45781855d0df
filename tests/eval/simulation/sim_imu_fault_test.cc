#include "eval/simulation/sim_imu_fault.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "eval/simulation/simulator.h"
#include "tests/eval/simulation/sim_scene.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Signal = Vector3d ImuSample::*;

constexpr unsigned kSeed = 3;

SimulatorConfig Config(SimFaultKind fault) {
  SimulatorConfig config = test::MinuteConfig();
  config.fault = fault;
  config.fault_start_s = 20;
  config.fault_duration_s = 3;
  return config;
}

std::vector<ImuSample> Samples(const SimulatorConfig& config, unsigned seed = kSeed) {
  const Result<Dataset> dataset = Simulate(config, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return dataset.ok() ? dataset->imu : std::vector<ImuSample>();
}

/// The samples of a fault beside those without it.
class SimImuFaultTest : public testing::Test {
 protected:
  void Make(SimFaultKind fault) {
    clean_ = Samples(Config(SimFaultKind::kNone));
    faulty_ = Samples(Config(fault));
    ASSERT_EQ(faulty_.size(), clean_.size());
    begin_ = 0;
    while (SecondsBetween(clean_.front().stamp_ns, clean_[begin_].stamp_ns) < 20) {
      ++begin_;
    }
    end_ = begin_;
    while (SecondsBetween(clean_.front().stamp_ns, clean_[end_].stamp_ns) < 23) {
      ++end_;
    }
    ASSERT_GT(end_ - begin_, 290u);
  }
  /// The other signal and all stamps throughout, and this signal outside of [begin_, end).
  void ExpectOthersUntouched(Signal signal, std::size_t end) {
    const Signal other = signal == &ImuSample::gyro ? &ImuSample::accel : &ImuSample::gyro;
    for (std::size_t k = 0; k < clean_.size(); ++k) {
      ASSERT_EQ(faulty_[k].stamp_ns, clean_[k].stamp_ns) << k;
      ASSERT_EQ(faulty_[k].*other, clean_[k].*other) << k;
      if (k < begin_ || k >= end) {
        ASSERT_EQ(faulty_[k].*signal, clean_[k].*signal) << k;
      }
    }
  }

  std::vector<ImuSample> clean_, faulty_;
  std::size_t begin_ = 0, end_ = 0;  ///< samples of the fault
};

TEST_F(SimImuFaultTest, ASaturatedSignalIsClippedAtHalfOfWhatItExceedsItsMeanBy) {
  for (const auto& [fault, signal] : {std::pair(SimFaultKind::kGyroSaturation, &ImuSample::gyro),
                                      std::pair(SimFaultKind::kAccelSaturation, &ImuSample::accel)}) {
    Make(fault);
    ExpectOthersUntouched(signal, end_);
    for (int axis = 0; axis < 3; ++axis) {
      double mean = 0, largest = 0;
      for (const ImuSample& sample : clean_) {
        mean += (sample.*signal)[axis] / static_cast<double>(clean_.size());
        largest = std::max(largest, std::abs((sample.*signal)[axis]));
      }
      const double limit = 0.5 * (std::abs(mean) + largest);
      for (std::size_t k = begin_; k < end_; ++k) {
        const double measured = (clean_[k].*signal)[axis];
        const double expected = std::abs(measured) > limit ? std::copysign(limit, measured) : measured;
        ASSERT_NEAR((faulty_[k].*signal)[axis], expected, 1e-9) << k;
      }
    }
    EXPECT_NE(faulty_[begin_ + 100].*signal, clean_[begin_ + 100].*signal) << "nothing was clipped";
  }
}

TEST_F(SimImuFaultTest, AStuckAxisRepeatsItsLastValueAndTheOthersGoOn) {
  for (const auto& [fault, signal] : {std::pair(SimFaultKind::kGyroStuck, &ImuSample::gyro),
                                      std::pair(SimFaultKind::kAccelStuck, &ImuSample::accel)}) {
    Make(fault);
    ExpectOthersUntouched(signal, end_);
    int stuck = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_stuck = (faulty_[begin_].*signal)[axis] != (clean_[begin_].*signal)[axis];
      stuck += is_stuck ? 1 : 0;
      for (std::size_t k = begin_; k < end_; ++k) {
        const double expected = (clean_[is_stuck ? begin_ - 1 : k].*signal)[axis];
        ASSERT_EQ((faulty_[k].*signal)[axis], expected) << k;
      }
    }
    EXPECT_EQ(stuck, 1);
  }
}

TEST_F(SimImuFaultTest, AFrozenSensorRepeatsAllItsAxes) {
  for (const bool both : {false, true}) {
    Make(both ? SimFaultKind::kImuFrozen : SimFaultKind::kGyroFrozen);
    for (std::size_t k = 0; k < clean_.size(); ++k) {
      const bool frozen = k >= begin_ && k < end_;
      ASSERT_EQ(faulty_[k].gyro, clean_[frozen ? begin_ - 1 : k].gyro) << k;
      ASSERT_EQ(faulty_[k].accel, clean_[frozen && both ? begin_ - 1 : k].accel) << k;
    }
  }
}

TEST(SimImuFaultSeedTest, TheSeedDrawsWhichAxisIsStuck) {
  std::set<int> axes;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SimulatorConfig config = Config(SimFaultKind::kGyroStuck);
    config.duration_s = 2;
    config.path_m = 2.6;
    config.fault_start_s = 1;
    const std::vector<ImuSample> samples = Samples(config, seed);
    ASSERT_GT(samples.size(), 150u);
    for (int axis = 0; axis < 3; ++axis) {
      if (samples[140].gyro[axis] == samples[150].gyro[axis]) {
        axes.insert(axis);
      }
    }
  }
  EXPECT_EQ(axes.size(), 3u);
}

TEST_F(SimImuFaultTest, AChangeOfUnitLastsToTheEndWhateverTheDuration) {
  Make(SimFaultKind::kImuUnit);
  ExpectOthersUntouched(&ImuSample::gyro, clean_.size());
  for (std::size_t k = begin_; k < clean_.size(); ++k) {
    ASSERT_LT((faulty_[k].gyro * std::numbers::pi / 180 - clean_[k].gyro).norm(), 1e-12) << k;
  }
}

TEST_F(SimImuFaultTest, AClockThatJumpedStaysOffAndStampsIncrease) {
  Make(SimFaultKind::kImuClock);
  for (std::size_t k = 0; k < clean_.size(); ++k) {
    ASSERT_EQ(faulty_[k].stamp_ns, clean_[k].stamp_ns + (k >= begin_ ? kSecondNs : 0)) << k;
    ASSERT_EQ(faulty_[k].gyro, clean_[k].gyro) << k;
    ASSERT_EQ(faulty_[k].accel, clean_[k].accel) << k;
    ASSERT_TRUE(k == 0 || faulty_[k].stamp_ns > faulty_[k - 1].stamp_ns) << k;
  }
}

TEST_F(SimImuFaultTest, AFaultOfTheImuLeavesTheTracksAlone) {
  const Result<Dataset> clean = Simulate(Config(SimFaultKind::kNone), kSeed);
  for (const SimFaultKind fault : {SimFaultKind::kGyroSaturation, SimFaultKind::kImuClock}) {
    const Result<Dataset> faulty = Simulate(Config(fault), kSeed);
    ASSERT_EQ(faulty->frames.size(), clean->frames.size());
    for (std::size_t i = 0; i < clean->frames.size(); ++i) {
      ASSERT_EQ(faulty->frames[i].stamp_ns, clean->frames[i].stamp_ns);
      ASSERT_EQ(faulty->frames[i].observations.size(), clean->frames[i].observations.size());
    }
  }
}

TEST(SimImuFaultConfigTest, AClockThatStepsBackIsRefused) {
  SimulatorConfig config = Config(SimFaultKind::kImuClock);
  EXPECT_TRUE(config.Validate().ok());
  config.fault_clock_jump_s = -1;
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
  EXPECT_NE(config.Validate().message().find("fault_clock_jump_s: -1"), std::string::npos);
}

}  // namespace
}  // namespace alidade
