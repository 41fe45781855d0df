#include "core/calibration_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "core/random.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::HasSubstr;

CalibrationConfig Watching() {
  CalibrationConfig config;
  config.watch = true;
  return config;
}

/// The information of the rows on a parameter, in its watched deviations: as little as of a minute of motion.
constexpr double kInformationShare = 1e-4;

/// Rows z = H_x x + H_t theta + n, n ~ N(0, 1), about a state with the prior N(0, I) and a calibration that
/// is wrong by `wrong`, in units in which a row has an entry of about one.
struct LinearWorld {
  explicit LinearWorld(int rows, unsigned seed, const VectorXd& wrong)
      : H_x(rows, 15), H_t(rows, wrong.size()), z(rows) {
    RandomStream random(seed, "watch");
    const auto fill = [&random](auto& matrix) {
      for (Eigen::Index i = 0; i < matrix.size(); ++i) {
        matrix.data()[i] = random.Normal();
      }
    };
    fill(H_x);
    fill(H_t);
    fill(z);
    VectorXd x(15);
    fill(x);
    z += H_x * x + H_t * wrong;
    const CalibrationEstimate prior = InitialCalibration(Watching(), CameraCalibration());
    H_t = (H_t * (kInformationShare * prior.deviations.cwiseInverse()).asDiagonal()).eval();
  }

  /// What an estimator that watches the calibration has, by its normal equations.
  [[nodiscard]] CalibrationEstimate Watched(Matrix15d* covariance) const {
    CalibrationEstimate estimate = InitialCalibration(Watching(), CameraCalibration());
    const Eigen::Index size = H_t.cols();
    MatrixXd H(z.size(), 15 + size);
    H << H_x, H_t;
    VectorXd prior = VectorXd::Ones(15 + size);
    prior.tail(size) = estimate.deviations.cwiseAbs2().cwiseInverse();
    // Scaled to unit diagonal of the prior: its entries are fourteen decades apart.
    const VectorXd scale = prior.cwiseSqrt().cwiseInverse();
    H = H * scale.asDiagonal();
    MatrixXd information = H.transpose() * H;
    information.diagonal().array() += 1;
    const MatrixXd P = scale.asDiagonal() * information.inverse() * scale.asDiagonal();
    const VectorXd mean =
        scale.asDiagonal() * VectorXd(information.ldlt().solve(VectorXd(H.transpose() * z)));
    *covariance = P.topLeftCorner<15, 15>();
    estimate.deviations = P.diagonal().tail(size).cwiseSqrt();
    estimate.error = mean.tail(size);
    estimate.state_covariance = P.topRightCorner(15, size);
    return estimate;
  }

  /// z of Rao's test of one parameter by the marginal distribution of the rows, and what it does to the
  /// state.
  [[nodiscard]] double Sigmas(int parameter, const std::vector<int>& axes, double* error,
                              double* pose_sigmas) const {
    const MatrixXd S = H_x * H_x.transpose() + MatrixXd::Identity(z.size(), z.size());
    const Eigen::LDLT<MatrixXd> inverse(S);
    const VectorXd h = H_t.col(parameter);
    const double information = h.dot(inverse.solve(h));
    *error = h.dot(inverse.solve(z)) / information;
    VectorXd shift = VectorXd::Zero(15);
    for (const int axis : axes) {
      const VectorXd h_axis = H_t.col(axis);
      const VectorXd weighted = inverse.solve(h_axis);
      shift += weighted.dot(z) / weighted.dot(h_axis) * (H_x.transpose() * weighted);
    }
    const MatrixXd P = MatrixXd::Identity(15, 15) - H_x.transpose() * inverse.solve(H_x);
    const VectorXd pose = shift.head<6>();
    *pose_sigmas = std::sqrt(pose.dot(P.topLeftCorner<6, 6>().ldlt().solve(pose)));
    return std::abs(*error) * std::sqrt(information);
  }

  MatrixXd H_x, H_t;
  VectorXd z;
};

TEST(CalibrationWatchTest, IsRaosTestOfTheParameterThatFitsWorst) {
  const std::vector<std::pair<int, const char*>> parameters = {
      {1, "rotation"}, {4, "position"}, {6, "time offset"}, {7, "focal length"}, {10, "principal point"}};
  const std::vector<std::vector<int>> axes = {{0, 1, 2}, {3, 4, 5}, {6}, {7, 8}, {9, 10}};
  const std::vector<double> unit = {kDegreesPerRadian, 1, 1e3, 1, 1};
  for (size_t k = 0; k < parameters.size(); ++k) {
    VectorXd wrong = VectorXd::Zero(11);
    wrong[parameters[k].first] = 3;
    const LinearWorld world(60, 7, wrong);
    Matrix15d covariance;
    const CalibrationDoubt doubt = FindCalibrationDoubt(world.Watched(&covariance), covariance);
    double error = 0;
    double pose_sigmas = 0;
    const double sigmas = world.Sigmas(parameters[k].first, axes[k], &error, &pose_sigmas);
    EXPECT_GT(sigmas, 8);
    EXPECT_THAT(doubt.parameter, HasSubstr(parameters[k].second));
    EXPECT_NEAR(doubt.sigmas, sigmas, 1e-4 * sigmas);
    EXPECT_NEAR(doubt.error, -unit[k] * error, 1e-4 * std::abs(unit[k] * error));
    EXPECT_NEAR(doubt.pose_sigmas, pose_sigmas, 1e-3 * pose_sigmas);
  }
}

TEST(CalibrationWatchTest, GivenTheRightCalibrationThenTheLargestOfElevenIsThatOfChance) {
  double sum = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    Matrix15d covariance;
    const CalibrationEstimate watched = LinearWorld(60, seed, VectorXd::Zero(11)).Watched(&covariance);
    const double sigmas = FindCalibrationDoubt(watched, covariance).sigmas;
    EXPECT_LT(sigmas, 4.5) << seed;
    sum += sigmas;
  }
  // Mean of the largest of 11 |N(0, 1)|: integral of 1 - erf(x / sqrt 2)^11 = 1.92; 200 draws are known to
  // 0.04.
  EXPECT_NEAR(sum / 200, 1.92, 0.15);
}

TEST(CalibrationWatchTest, WithoutDataNothingIsDoubted) {
  const CalibrationEstimate prior = InitialCalibration(Watching(), CameraCalibration());
  EXPECT_TRUE(prior.watched);
  EXPECT_EQ(prior.layout.size(), 11);
  const CalibrationDoubt doubt = FindCalibrationDoubt(prior, Matrix15d::Identity());
  EXPECT_EQ(doubt.sigmas, 0);
  EXPECT_EQ(doubt.pose_sigmas, 0);
}

TEST(CalibrationWatchTest, TheLeverArmOfAnAntennaComesLast) {
  CalibrationEstimate watched = InitialCalibration(Watching(), CameraCalibration(), Sensor::kGnss);
  ASSERT_EQ(watched.layout.size(), 14);
  EXPECT_EQ(watched.layout.lever_arm(), 11);
  EXPECT_EQ(InitialCalibration({}, CameraCalibration(), Sensor::kGnss).layout.size(), 0);
  // 10 sigma of the second axis, half a metre, with 1e4 of information.
  const double precision = 1 / (watched.deviations[12] * watched.deviations[12]) + 400;
  watched.deviations[12] = 1 / std::sqrt(precision);
  watched.error[12] = 0.5 * 400 / precision;
  const CalibrationDoubt doubt = FindCalibrationDoubt(watched, Matrix15d::Identity());
  EXPECT_STREQ(doubt.parameter, "the lever arm of the GNSS antenna");
  EXPECT_NEAR(doubt.sigmas, 10, 0.01);
  EXPECT_NEAR(doubt.error, -0.5, 1e-3);
}

TEST(CalibrationWatchTest, WhatIsEstimatedIsNotWatched) {
  CalibrationConfig config = Watching();
  config.time_offset = true;
  const CalibrationEstimate estimate = InitialCalibration(config, CameraCalibration());
  EXPECT_FALSE(estimate.watched);
  EXPECT_EQ(estimate.layout.size(), 1);
  EXPECT_EQ(estimate.deviations[0], config.time_offset_std_s);
}

}  // namespace
}  // namespace alidade
