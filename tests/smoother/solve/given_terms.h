#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "smoother/factors/imu_factor.h"
#include "smoother/solve/factor_term.h"
#include "smoother/solve/marginalization.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/window_system.h"
#include "smoother/tracks/track_system.h"
#include "tests/support/jacobian_checker.h"

namespace alidade::test {

/// Normal equations over the poses of a window and its calibration, as a term.
class GivenTerm final : public WindowTerm {
 public:
  explicit GivenTerm(const PoseSystem& system) : system_(system) {
    for (int i = 0; system.columns.Frame(i).size > 0; ++i) {
      AddPart({Unknown::Kind::kFrame, i}, system.columns.Frame(i).size);
    }
    AddPart({Unknown::Kind::kCalibration, 0}, system.columns.Calibration().size);
  }
  Status Linearize(LinearTerm* linear) const override {
    linear->SetInformation(parts(), {system_.hessian, system_.gradient});
    return Status::Ok();
  }
  void AddTo(WindowProblem*) override { FAIL() << "a linear problem only"; }

 private:
  PoseSystem system_;
};

/// The sensors' terms of a window and its vision.
inline WindowTerms MakeTerms(const Window& window, const PoseSystem& vision, const SensorContext& sensors) {
  WindowTerms terms;
  const Status status = AddSensorTerms(sensors, window.frames(), window.size(), &terms);
  EXPECT_TRUE(status.ok()) << status.message();
  terms.push_back(std::make_unique<GivenTerm>(vision));
  return terms;
}

/// The spread of a prior's frames, each moved by an error of the prior's convention about the origin of W.
inline Eigen::VectorXd LogSpread(const LinearPrior& prior, const Eigen::VectorXd& delta) {
  Eigen::Matrix3Xd cameras(3, prior.anchors.size());
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    Vector9d xi = Vector9d::Zero();
    xi.head<6>() = delta.segment<6>(6 * column);
    cameras.col(column) = Retract(prior.chart.convention, prior.anchors[i].origin, xi).T_WB() *
                          prior.calibration_origin.mean.T_BC.translation;
  }
  const Eigen::Vector3d mean = cameras.rowwise().mean();
  return Eigen::VectorXd::Constant(1, 0.5 * std::log((cameras.colwise() - mean).squaredNorm()));
}

/// The columns of a prior with a spread, over the inverse depths themselves.
inline void AddSpread(const LinearPrior& prior, Eigen::MatrixXd* rows) {
  const ColumnMap columns = prior.columns();
  const auto spread = [&](const Eigen::VectorXd& delta) { return LogSpread(prior, delta); };
  const Eigen::MatrixXd slope = NumericJacobian(spread, static_cast<int>(6 * prior.anchors.size()));
  for (size_t l = 0; l < prior.landmarks.size(); ++l) {
    const Eigen::VectorXd along_scale =
        prior.landmarks[l].origin.z() * rows->col(columns.Landmark(static_cast<int>(l)).first + 2);
    for (size_t i = 0; i < prior.anchors.size(); ++i) {
      rows->middleCols<6>(columns.Frame(static_cast<int>(i)).first) +=
          along_scale * slope.middleCols<6>(6 * static_cast<Eigen::Index>(i));
    }
  }
}

/// The rows of a prior at its origins, over errors about W's origin.
inline Eigen::MatrixXd RowsAboutOrigin(const LinearPrior& prior) {
  Eigen::MatrixXd rows = prior.jacobian;
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    const NavState& state = prior.anchors[i].origin;
    const ColumnMap::Range at = prior.columns().Frame(static_cast<int>(i));
    const Matrix15d change = InverseImuChartJacobian(prior.chart.convention, prior.chart.FromCentre(state)) *
                             ImuChartJacobian(prior.chart.convention, state);
    rows.middleCols(at.first, at.size) =
        prior.jacobian.middleCols(at.first, at.size) * change.topLeftCorner(at.size, at.size);
  }
  if (prior.spread > 0) {
    AddSpread(prior, &rows);
  }
  return rows;
}

inline LinearPrior Marginalize(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                               const SensorContext& sensors, const SlamChange& slam = {}) {
  const WindowTerms terms = MakeTerms(window, vision, sensors);
  const WindowCalibration none;
  Result<LinearPrior> next = MarginalizeOldest(
      window, prior, vision.calibration == nullptr ? none : *vision.calibration, terms, slam);
  EXPECT_TRUE(next.ok()) << next.message();
  return *next;
}

/// What is known of the newest frame; `slam` stands for a prior with landmarks.
inline NewestEstimate Newest(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                             const SensorContext& sensors, std::unique_ptr<WindowTerm> slam = nullptr) {
  const WindowCalibration none;
  const WindowCalibration& calibration = vision.calibration == nullptr ? none : *vision.calibration;
  WindowTerms terms = MakeTerms(window, vision, sensors);
  terms.insert(terms.begin(), slam != nullptr ? std::move(slam) : MakePriorTerm(prior, calibration));
  NewestEstimate newest;
  EXPECT_TRUE(NewestCovariance(window.frames(), terms, &newest));
  return newest;
}

/// Whitened rows of the IMU between two frames, over 15 canonical coordinates of each.
struct ImuRows {
  Matrix15d first, second;
  Vector15d residual;
};
inline ImuRows LinearizeImu(const WindowFrame& from, const WindowFrame& to,
                            const Eigen::Vector3d& gravity_W) {
  const ImuFactor factor(&*to.preintegration, gravity_W, from.first_estimate(), to.first_estimate());
  LinearTerm linear;
  EXPECT_TRUE(MakeTerm(factor, {NavBlock(from), BiasBlock(from), NavBlock(to), BiasBlock(to)})
                  ->Linearize(&linear)
                  .ok());
  return {linear.jacobian.leftCols<15>(), linear.jacobian.rightCols<15>(), linear.residual};
}

}  // namespace alidade::test
