#include "filter/window_shape.h"

#include <gtest/gtest.h>

#include "tests/support/cloned_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

class WindowShapeTest : public test::ClonedWindow {
 protected:
  /// The oldest camera's position as the newest one sees it, after both errors.
  [[nodiscard]] Vector3d OldestPlace(const VectorXd& error) const {
    const auto camera = [&](size_t i) {
      return Retract(GetParam(), state_.clones()[i].T_WB, error.segment<6>(state_.CloneOffset(i))) * T_BC_;
    };
    const Pose newest = camera(state_.clones().size() - 1);
    return newest.rotation.transpose() * (camera(0).translation - newest.translation);
  }
};

INSTANTIATE_TEST_SUITE_P(Conventions, WindowShapeTest, ::testing::ValuesIn(test::kAllConventions));

TEST_P(WindowShapeTest, AWorldThatIsMovedAsAWholeIsNotDeformed) {
  const Matrix3d turn = so3::Exp({1e-4, -2e-4, 3e-4});
  const VectorXd moved = CorrectionTo([&](const Clone& clone) {
    const Pose& T_WB = clone.T_WB;
    return Pose{turn * T_WB.rotation, turn * T_WB.translation + Vector3d(1e-3, 2e-3, -1e-3)};
  });
  EXPECT_LT(RelativeDeformation(state_, moved), 1e-6);
}

TEST_P(WindowShapeTest, AWorldOfAnotherScaleIsDeformedByIt) {
  const VectorXd scaled = CorrectionTo([&](const Clone& clone) {
    const Pose& T_WB = clone.T_WB;
    // The cameras' positions, not the bodies'.
    const Vector3d lever = T_WB.rotation * T_BC_.translation;
    return Pose{T_WB.rotation, 1.001 * (T_WB.translation + lever) - lever};
  });
  EXPECT_NEAR(RelativeDeformation(state_, scaled), 1e-3, 1e-6);
}

TEST_P(WindowShapeTest, DeviationsAreThoseOfTheNumericJacobian) {
  const auto dimension = static_cast<Eigen::Index>(state_.covariance().dimension());
  const MatrixXd jacobian = test::NumericJacobian(
      [&](const VectorXd& error) -> VectorXd { return OldestPlace(error); }, static_cast<int>(dimension));
  const Matrix3d covariance = jacobian * state_.covariance().Covariance() * jacobian.transpose();
  const Vector3d place = OldestPlace(VectorXd::Zero(dimension));
  const Vector3d line = place.normalized();
  const double along = line.dot(covariance * line);
  const BaselineDeviation deviation = MeasureBaseline(state_);
  EXPECT_NEAR(deviation.along, std::sqrt(along) / place.norm(), 1e-4 * deviation.along);
  EXPECT_NEAR(deviation.across, std::sqrt(covariance.trace() - along) / place.norm(),
              1e-4 * deviation.across);
}

}  // namespace
}  // namespace alidade
