#pragma once

#include <array>
#include <span>
#include <variant>

#include "core/imu_propagation.h"
#include "smoother/manifold/lifted_cost.h"
#include "smoother/window/frame_measurement.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// A measurement between frames as a factor over blocks nav and bias of its frame, and the calibration where
/// that has its lever arm. `Kind`: the alternative of WhitenedMeasurement that it is.
template <typename Kind>
class MeasurementFactor {
 public:
  static constexpr int kRows = Kind::kRows;

  /// All must outlive the factor.
  MeasurementFactor(const FrameMeasurement* measurement, const Eigen::Vector3d& gravity_W,
                    const CalibrationLayout& layout = NotCalibrated().layout)
      : measurement_(measurement), gravity_W_(gravity_W), layout_(&layout) {}

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const {
    return std::span(kBlocks).first(sees_calibration() ? 3 : 2);
  }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const {
    NavState nav = UnpackNavState(parameters[0]);
    Matrix15d carry = Matrix15d::Identity();
    if (measurement_->preintegration) {
      nav = CarryState(*measurement_->preintegration, nav, UnpackBias(parameters[1]), gravity_W_, &carry);
    }
    typename Kind::Residual whitened;
    typename Kind::Jacobian jacobian;
    std::get<Kind>(measurement_->measurement).Evaluate(nav, &whitened, &jacobian);
    Eigen::Map<typename Kind::Residual>{residual} = whitened;
    jacobian = (jacobian * carry).eval();
    if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kRows, 9, Eigen::RowMajor>>{tangent_jacobians[0]} =
          jacobian.template leftCols<9>();
    }
    if (tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kRows, 6, Eigen::RowMajor>>{tangent_jacobians[1]} =
          jacobian.template rightCols<6>();
    }
    if constexpr (HasLeverArm<Kind>) {
      if (sees_calibration() && tangent_jacobians != nullptr && tangent_jacobians[2] != nullptr) {
        PutLeverArm(*layout_, std::get<Kind>(measurement_->measurement).LeverArmJacobian(nav),
                    tangent_jacobians[2]);
      }
    }
    return true;
  }

 private:
  static constexpr std::array<BlockKind, 3> kBlocks = {BlockKind::kNavState, BlockKind::kBias,
                                                       BlockKind::kCalibration};
  [[nodiscard]] bool sees_calibration() const {
    return HasLeverArm<Kind> && layout_->antenna() == SensorOf(measurement_->measurement);
  }
  const FrameMeasurement* measurement_;
  Eigen::Vector3d gravity_W_;
  const CalibrationLayout* layout_;
};

}  // namespace alidade
