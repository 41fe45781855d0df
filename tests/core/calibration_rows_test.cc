// Rows of a track's residuals over the calibration, from every visual model.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "core/calibration.h"
#include "core/inverse_depth.h"
#include "core/landmark_reduction.h"
#include "core/pose_only.h"
#include "tests/core/calibration_fixture.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/pose_only_model.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::Everything;
using test::kLenses;
using test::MakeCamera;
using test::RandomStates;

/// A landmark seen from bodies in motion, in pixels.
struct Rig {
  CameraCalibration calibration;
  Vector3d point;
  std::vector<NavState> bodies;
  std::vector<Vector3d> omegas;
  std::vector<Vector2d> pixels;

  Rig(RandomStates* random, DistortionModel lens, int views) {
    calibration.camera = MakeCamera(lens);
    calibration.T_BC = random->RandomPose(0.2);
    calibration.time_offset_s = 0.01;
    point = random->Vector(5);
    for (const Pose& T_WC : random->CamerasLookingAt(point, views, 6, 1.0)) {
      const Pose T_WB = T_WC * calibration.T_BC.Inverse();
      bodies.push_back({T_WB.rotation, T_WB.translation, random->Vector(2)});
      omegas.push_back(random->Vector(1));
      Vector2d pixel;
      EXPECT_TRUE(calibration.camera.Project(T_WC.Inverse() * point, &pixel));
      pixels.push_back(pixel + Vector2d(random->Uniform(-2, 2), random->Uniform(-2, 2)));
    }
  }

  /// Camera poses with the given calibration: a later exposure sees from where the body is then.
  [[nodiscard]] std::vector<Pose> Views(const CameraCalibration& with, const std::vector<Pose>& T_WB) const {
    const double dt = with.time_offset_s - calibration.time_offset_s;
    std::vector<Pose> views;
    for (size_t k = 0; k < bodies.size(); ++k) {
      const Pose then{T_WB[k].rotation * so3::Exp(omegas[k] * dt), T_WB[k].translation + bodies[k].v_WB * dt};
      views.push_back(then * with.T_BC);
    }
    return views;
  }
  [[nodiscard]] std::vector<Pose> Bodies() const {
    std::vector<Pose> poses;
    for (const NavState& body : bodies) {
      poses.push_back(body.T_WB());
    }
    return poses;
  }
  /// Rays of the pixels through the lens, with the whitening of the calibration's own lens.
  [[nodiscard]] std::vector<NormalizedObservation> Observe(const CameraCalibration& with) const {
    std::vector<NormalizedObservation> observations;
    for (const Vector2d& pixel : pixels) {
      NormalizedObservation observation;
      NormalizedObservation whitening;
      EXPECT_TRUE(NormalizeObservation(with.camera, pixel, 1.5, &observation));
      EXPECT_TRUE(NormalizeObservation(calibration.camera, pixel, 1.5, &whitening));
      observation.sqrt_information = whitening.sqrt_information;
      observations.push_back(observation);
    }
    return observations;
  }
  [[nodiscard]] Vector6d CameraFromTime(size_t k) const {
    return BodyToCameraJacobian(bodies[k].R_WB, calibration.T_BC) * BodyRates(omegas[k], bodies[k].v_WB);
  }
};

/// The rows over bodies and calibration, 2N x (6N + size), from those over the cameras.
MatrixXd ChainRows(const Rig& rig, const CalibrationLayout& layout, const TrackLinearization& track,
                   const std::vector<NormalizedObservation>& observations, ErrorConvention convention) {
  const auto count = static_cast<Eigen::Index>(rig.bodies.size());
  MatrixXd rows = MatrixXd::Zero(2 * count, 6 * count + layout.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto view = static_cast<size_t>(k);
    const Eigen::Matrix<double, 2, 6> camera = track.pose_jacobians.middleRows<2>(2 * k);
    const Vector6d from_time = rig.CameraFromTime(view);
    rows.block<2, 6>(2 * k, 6 * k) = camera *
                                     BodyToCameraJacobian(rig.bodies[view].R_WB, rig.calibration.T_BC) *
                                     ChartJacobian(convention, rig.bodies[view].T_WB());
    CalibrationRows(layout, rig.calibration.camera, rig.bodies[view].R_WB, {&from_time}, camera,
                    observations[view], rows.block(2 * k, 6 * count, 2, layout.size()));
  }
  return rows;
}

std::vector<Pose> MoveBodies(const Rig& rig, ErrorConvention convention, const VectorXd& xi) {
  std::vector<Pose> moved = rig.Bodies();
  for (size_t k = 0; k < moved.size(); ++k) {
    moved[k] = Retract(convention, moved[k], Vector6d(xi.segment<6>(static_cast<Eigen::Index>(6 * k))));
  }
  return moved;
}

TEST(CalibrationTest, RowsOfATrackAreNumericInEveryConvention) {
  RandomStates random(53);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 24; ++trial) {
      const Rig rig(&random, kLenses[trial % 4], 3 + trial % 3);
      const CalibrationLayout layout(Everything(), rig.calibration.camera);
      const std::vector<NormalizedObservation> observations = rig.Observe(rig.calibration);
      TrackLinearization track;
      ASSERT_TRUE(LinearizeTrack(rig.Views(rig.calibration, rig.Bodies()), observations, rig.point, &track));
      const int poses = 6 * static_cast<int>(rig.bodies.size());
      const auto residual = [&](const VectorXd& xi) -> VectorXd {
        CameraCalibration moved = rig.calibration;
        EXPECT_TRUE(Retract(layout, xi.tail(layout.size()), &moved));
        TrackLinearization there;
        EXPECT_TRUE(LinearizeTrack(rig.Views(moved, MoveBodies(rig, convention, xi)), rig.Observe(moved),
                                   rig.point, &there));
        return there.residual;
      };
      EXPECT_EQ(test::CompareJacobians(ChainRows(rig, layout, track, observations, convention),
                                       test::NumericJacobian(residual, poses + layout.size()), 1e-7),
                "");
    }
  }
}

/// d residual / d (bodies, calibration) of PoseOnlyModel, from its rows over the cameras and over the rays.
MatrixXd PoseOnlyRows(const Rig& rig, const CalibrationLayout& layout, const test::PoseOnlyModel& model,
                      ErrorConvention convention) {
  std::vector<Vector2d> z;
  for (const NormalizedObservation& observation : rig.Observe(rig.calibration)) {
    z.push_back(observation.z);
  }
  const auto count = static_cast<Eigen::Index>(z.size());
  PoseOnlyDepth depth;
  VectorXd residual;
  MatrixXd over_cameras;
  MatrixXd over_rays;
  EXPECT_TRUE(model.Evaluate(rig.Views(rig.calibration, rig.Bodies()), z, &depth, &residual, &over_cameras,
                             &over_rays));
  over_rays -= MatrixXd::Identity(2 * count, 2 * count);
  MatrixXd rows = MatrixXd::Zero(2 * count, 6 * count + layout.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto view = static_cast<size_t>(k);
    const Eigen::Matrix3d& R_WB = rig.bodies[view].R_WB;
    rows.middleCols<6>(6 * k) = over_cameras.middleCols<6>(6 * k) *
                                BodyToCameraJacobian(R_WB, rig.calibration.T_BC) *
                                ChartJacobian(convention, rig.bodies[view].T_WB());
    auto calibration = rows.rightCols(layout.size());
    calibration.middleCols<6>(layout.extrinsics()) +=
        over_cameras.middleCols<6>(6 * k) * ExtrinsicsToCameraJacobian(R_WB);
    calibration.col(layout.time_offset()) += over_cameras.middleCols<6>(6 * k) * rig.CameraFromTime(view);
    MatrixXd minus_rays(2, layout.size());
    CalibrationRows(layout, rig.calibration.camera, R_WB, {}, Eigen::Matrix<double, 2, 6>::Zero(),
                    {z[view], Eigen::Matrix2d::Identity()}, minus_rays);
    calibration -= over_rays.middleCols<2>(2 * k) * minus_rays;
  }
  return rows;
}

TEST(CalibrationTest, PoseOnlyResidualIsNumericInEveryConvention) {
  RandomStates random(54);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 24; ++trial) {
      const Rig rig(&random, kLenses[trial % 4], 3 + trial % 3);
      const CalibrationLayout layout(Everything(), rig.calibration.camera);
      const test::PoseOnlyModel model{trial % 3, trial % 2 == 0 ? DepthViews::kMulti : DepthViews::kTwo};
      const auto residual = [&](const VectorXd& xi) -> VectorXd {
        CameraCalibration moved = rig.calibration;
        EXPECT_TRUE(Retract(layout, xi.tail(layout.size()), &moved));
        std::vector<Vector2d> z;
        for (const NormalizedObservation& observation : rig.Observe(moved)) {
          z.push_back(observation.z);
        }
        PoseOnlyDepth depth;
        VectorXd r;
        EXPECT_TRUE(model.Evaluate(rig.Views(moved, MoveBodies(rig, convention, xi)), z, &depth, &r, nullptr,
                                   nullptr));
        return r;
      };
      const int size = 6 * static_cast<int>(rig.bodies.size()) + layout.size();
      EXPECT_EQ(test::CompareJacobians(PoseOnlyRows(rig, layout, model, convention),
                                       test::NumericJacobian(residual, size), 1e-6),
                "");
    }
  }
}

TEST(CalibrationTest, PoseOnlyAndFixedLandmarkLeaveTheSameRows) {
  // N^T of the total derivative is N^T of the rows with the landmark held fixed, calibration included.
  RandomStates random(55);
  for (int trial = 0; trial < 20; ++trial) {
    const Rig rig(&random, kLenses[trial % 4], 4);
    const CalibrationLayout layout(Everything(), rig.calibration.camera);
    const std::vector<Pose> views = rig.Views(rig.calibration, rig.Bodies());
    std::vector<NormalizedObservation> observations = rig.Observe(rig.calibration);
    for (NormalizedObservation& observation : observations) {
      observation.sqrt_information.setIdentity();
    }
    PoseOnlyDepth depth;
    ASSERT_TRUE(ComputePoseOnlyDepth(views, observations, 0, DepthViews::kMulti, &depth));
    TrackLinearization track;
    ASSERT_TRUE(LinearizeTrack(views, observations, depth.p_W, &track));
    const ErrorConvention convention = ErrorConvention::kRightInvariant;
    MatrixXd both(8, 2 * (24 + layout.size()));
    both << ChainRows(rig, layout, track, observations, convention),
        PoseOnlyRows(rig, layout, {0, DepthViews::kMulti}, convention);
    const double scale = both.norm();
    EliminateLandmark(track.point_jacobian, both, track.residual);
    const MatrixXd rows = both.bottomRows<5>();
    EXPECT_LT((rows.leftCols(24 + layout.size()) - rows.rightCols(24 + layout.size())).norm(), 1e-10 * scale);
  }
}

TEST(CalibrationTest, InverseDepthResidualIsNumericInEveryConvention) {
  RandomStates random(56);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 24; ++trial) {
      const Rig rig(&random, kLenses[trial % 4], 2);
      CalibrationConfig config = Everything();
      config.intrinsics = false;  // the model takes rays
      const CalibrationLayout layout(config, rig.calibration.camera);
      const std::vector<NormalizedObservation> rays = rig.Observe(rig.calibration);
      const InverseDepthModel model{rays[1].z};
      const Eigen::Vector3d landmark(rays[0].z.x(), rays[0].z.y(), 1.0 / 6);
      const auto evaluate = [&](const std::vector<Pose>& views, InverseDepthModel::PoseJacobian* base,
                                InverseDepthModel::PoseJacobian* view) {
        Vector2d r;
        EXPECT_TRUE(model.Evaluate(views[0], views[1], landmark, &r, base, view, nullptr));
        return r;
      };
      std::array<InverseDepthModel::PoseJacobian, 2> jacobians;
      evaluate(rig.Views(rig.calibration, rig.Bodies()), &jacobians[0], &jacobians[1]);
      MatrixXd analytic = MatrixXd::Zero(2, 12 + layout.size());
      for (size_t k = 0; k < 2; ++k) {
        MatrixXd rows(2, layout.size());
        const Vector6d from_time = rig.CameraFromTime(k);
        CalibrationRows(layout, rig.calibration.camera, rig.bodies[k].R_WB, {&from_time}, jacobians[k],
                        rays[k], rows);
        analytic.rightCols(layout.size()) += rows;
        analytic.middleCols<6>(6 * static_cast<Eigen::Index>(k)) =
            jacobians[k] * BodyToCameraJacobian(rig.bodies[k].R_WB, rig.calibration.T_BC) *
            ChartJacobian(convention, rig.bodies[k].T_WB());
      }
      const auto residual = [&](const VectorXd& xi) -> VectorXd {
        CameraCalibration moved = rig.calibration;
        EXPECT_TRUE(Retract(layout, xi.tail(layout.size()), &moved));
        return evaluate(rig.Views(moved, MoveBodies(rig, convention, xi)), nullptr, nullptr);
      };
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(residual, 12 + layout.size()), 1e-7),
                "");
    }
  }
}

}  // namespace
}  // namespace alidade
