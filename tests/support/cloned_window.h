#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "core/imu_buffer.h"
#include "filter/filter_state.h"
#include "tests/support/scenario.h"

namespace alidade::test {

constexpr int kClonedFrames = 9;

/// The simulation of two seconds to which the clones belong.
inline SimulatorConfig ClonedFlight() {
  SimulatorConfig config;
  config.duration_s = 2;
  config.path_m = 2.62;
  return config;
}

/// A filter state with a clone for each of the first `frames` frames of a simulation; nothing updated yet.
inline FilterState CloneEveryFrame(const Dataset& dataset, ErrorConvention convention,
                                   const NavEstimate& initial, int frames = kClonedFrames) {
  FilterState state(convention, false, dataset.rig.T_BC, {.clones = frames + 1, .imu_strain = true});
  EXPECT_TRUE(state.Reset(initial).ok());
  ImuBuffer imu(1.0);
  for (const ImuSample& sample : dataset.imu) {
    EXPECT_TRUE(imu.Add(sample).ok());
  }
  for (int k = 0; k < frames; ++k) {
    const TimeNs stamp_ns = dataset.frames[static_cast<size_t>(k)].stamp_ns;
    if (k > 0) {
      std::vector<ImuSample> interval;
      EXPECT_TRUE(imu.Interval(state.stamp_ns(), stamp_ns, &interval).ok());
      EXPECT_TRUE(state.Propagate(interval, dataset.rig.imu_noise, Eigen::Vector3d(0, 0, -9.81)).ok());
    }
    state.AddClone(k);
  }
  return state;
}

inline FilterState CloneEveryFrame(const Dataset& dataset, ErrorConvention convention) {
  return CloneEveryFrame(dataset, convention, DrawInitialState(dataset, 1));
}

/// Such a state in the convention that is the test's parameter.
class ClonedWindow : public ::testing::TestWithParam<ErrorConvention> {
 protected:
  ClonedWindow() : ClonedWindow(SimulateOrDie(ClonedFlight(), 1)) {}

  /// The correction that takes every body of `state` to where `move` puts its clone.
  template <typename Move>
  [[nodiscard]] Eigen::VectorXd CorrectionTo(const FilterState& state, Move move) const {
    Eigen::VectorXd correction = Eigen::VectorXd::Zero(state.covariance().dimension());
    for (size_t i = 0; i < state.clones().size(); ++i) {
      const Clone& clone = state.clones()[i];
      correction.segment<6>(state.CloneOffset(i)) = Local(GetParam(), clone.T_WB, move(clone));
    }
    return correction;
  }
  template <typename Move>
  [[nodiscard]] Eigen::VectorXd CorrectionTo(Move move) const {
    return CorrectionTo(state_, move);
  }

  FilterState state_;
  Pose T_BC_;

 private:
  explicit ClonedWindow(const Dataset& dataset)
      : state_(CloneEveryFrame(dataset, GetParam())), T_BC_(dataset.rig.T_BC) {}
};

}  // namespace alidade::test
