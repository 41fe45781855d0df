#pragma once

#include <gtest/gtest.h>

#include "filter/slam_features.h"

namespace alidade::test {

inline constexpr double kFlightSigma = 2e-3;
inline const Eigen::Vector3d kFlightPoint(1.5, -0.8, 9);
inline const Eigen::Vector3d kFlightGravity = GravityInWorld(9.81);

/// A filter state that flies sideways past one landmark, frame after frame, and a track of it.
class Flight {
 public:
  Flight(ErrorConvention convention, bool first_estimates, double velocity_std = 0.01)
      : state_(convention, first_estimates, {so3::Exp({0.1, -0.2, 0.05}), {0.1, 0.02, -0.05}}, {12, 4}),
        update_(Filter(), VisionConfig(), 12),
        slam_(Filter(), 12) {
    NavEstimate initial;
    initial.nav = {so3::Exp({0.05, 0.1, -0.1}), {0.3, -0.2, 0.1}, {1.0, 0.4, 0.2}};
    initial.covariance.diagonal() << Vector15d::Constant(1e-4);
    initial.covariance.diagonal().segment<3>(6).setConstant(velocity_std * velocity_std);
    EXPECT_TRUE(state_.Reset(initial).ok());
    track_.id = 7;
  }

  /// Propagates over 0.2 s, clones, and observes the landmark (`noise`: on the normalised plane).
  void Frame(const Eigen::Vector2d& noise = Eigen::Vector2d::Zero()) {
    const auto stamp = [this](int i) { return static_cast<TimeNs>(200'000'000) * serial_ + 20'000'000 * i; };
    std::vector<ImuSample> samples;
    for (int i = 0; i <= 10; ++i) {
      samples.push_back({stamp(i), {0.1, 0.05, -0.08}, {0.2, 0.3, 9.9}});
    }
    const ImuNoise noise_model{3e-4, 1e-3, 3e-5, 2e-4};
    EXPECT_TRUE(state_.Propagate(samples, noise_model, kFlightGravity).ok());
    state_.AddClone(++serial_);
    TrackView view;
    view.serial = serial_;
    view.observation.z = (state_.clones().back().T_WC.Inverse() * kFlightPoint).hnormalized() + noise;
    view.observation.sqrt_information = Eigen::Matrix2d::Identity() / kFlightSigma;
    track_.views.push_back(view);
    track_.last_serial = serial_;
    ++track_.observations;
  }

  /// Applies what update_ holds, corrects and returns the correction.
  Eigen::VectorXd Apply() {
    Eigen::VectorXd correction(state_.covariance().dimension());
    Eigen::MatrixXd rows = update_.jacobian();
    Eigen::VectorXd innovation = update_.innovation();
    EXPECT_TRUE(
        state_.covariance().Apply(state_.covariance().Prepare(rows, innovation), correction, nullptr));
    state_.Correct(correction);
    return correction;
  }

  void EnterLandmark() {
    TrackStore store;
    store.tracks().push_back(track_);
    update_.Begin(state_);
    slam_.Begin();
    ASSERT_TRUE(slam_.IsCandidate(state_, track_, serial_));
    ASSERT_EQ(update_.AppendLandmark(state_, track_, slam_.TakeRows()), TrackOutcome::kReady);
    slam_.AssignBlock(0);
    slam_.Enter(Apply(), {1.0}, &state_, &store);
    EXPECT_TRUE(store.tracks().front().in_state);
    track_.in_state = true;
  }

  /// The rows of the landmark's newest observation at `state`.
  void ObserveLandmark(const FilterState& state) {
    update_.Begin(state);
    ASSERT_EQ(slam_.Append(state, track_, &update_), TrackOutcome::kReady);
  }

  static FilterConfig Filter() {
    FilterConfig filter;
    filter.landmark = FilterLandmark::kMsckf;
    filter.slam_features = 4;
    filter.slam_min_track = 5;
    return filter;
  }

  FilterState state_;
  FeatureUpdate update_;
  SlamFeatures slam_;
  Track track_;
  int serial_ = 0;
};

}  // namespace alidade::test
