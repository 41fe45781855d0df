#pragma once

#include <ceres/cost_function.h>

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/calibration.h"
#include "smoother/manifold/nav_state_manifold.h"

namespace alidade {

/// Kinds of parameter blocks. Ceres sees the ambient size; factors work in tangent columns of the canonical
/// chart.
enum class BlockKind {
  kNavState,     ///< quaternion, p, v; tangent (phi, dp, dv)
  kBias,         ///< gyro, accel
  kClock,        ///< core/clock_state.h
  kCalibration,  ///< smoother/window/window_calibration.h
  kLandmark,     ///< (x, y, rho): bearing on the base view's normalised plane and inverse depth [1/m]
};

[[nodiscard]] constexpr int AmbientSize(BlockKind kind) {
  switch (kind) {
    case BlockKind::kNavState:
      return kNavAmbientSize;
    case BlockKind::kCalibration:
      return CalibrationLayout::kMaxSize;
    case BlockKind::kLandmark:
      return 3;
    case BlockKind::kBias:
    case BlockKind::kClock:
      break;
  }
  return 6;
}
[[nodiscard]] constexpr int TangentSize(BlockKind kind) {
  return kind == BlockKind::kNavState ? kNavTangentSize : AmbientSize(kind);
}

/// Writes rows over a lever arm, rows x 3, into the row-major tangent Jacobian of a calibration's block.
inline void PutLeverArm(const CalibrationLayout& layout, const Eigen::Ref<const Eigen::MatrixXd>& rows,
                        double* tangent_jacobian) {
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, CalibrationLayout::kMaxSize, Eigen::RowMajor>;
  Eigen::Map<Jacobian> jacobian(tangent_jacobian, rows.rows(), CalibrationLayout::kMaxSize);
  jacobian.setZero();
  jacobian.middleCols<3>(layout.lever_arm()) = rows;
}

/// Makes a Ceres cost function of a factor. A Factor has
///
///   static constexpr int kRows;                      rows, or Eigen::Dynamic
///   int rows() const;
///   std::span<const BlockKind> blocks() const;
///   bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians)
///   const;
///
/// where Evaluate returns the WHITENED residual and its row-major Jacobians in the canonical chart
/// (tangent_jacobians, or any entry of it, may be null), and false where the factor is undefined. The lift to
/// the ambient block is done here and nowhere else, by RotationLift (= chart Jacobian times the manifold's
/// MinusJacobian), so that after Ceres has multiplied with the PlusJacobian of whichever convention's
/// manifold is installed, it holds J_zeta C.
template <typename Factor>
class LiftedCost final : public ceres::CostFunction {
 public:
  explicit LiftedCost(Factor factor) : factor_(std::move(factor)) {
    set_num_residuals(factor_.rows());
    for (const BlockKind kind : factor_.blocks()) {
      mutable_parameter_block_sizes()->push_back(AmbientSize(kind));
      tangent_doubles_ += factor_.rows() * TangentSize(kind);
    }
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    if (jacobians == nullptr) {
      return factor_.Evaluate(parameters, residuals, nullptr);
    }
    std::array<double, kStackDoubles> small;
    std::vector<double> large;
    double* storage = small.data();
    if (tangent_doubles_ > kStackDoubles) {
      large.resize(static_cast<size_t>(tangent_doubles_));
      storage = large.data();
    }
    std::array<double*, kMaxBlocks> tangents;
    const std::span<const BlockKind> blocks = factor_.blocks();
    for (size_t i = 0; i < blocks.size(); ++i) {
      const bool is_nav = blocks[i] == BlockKind::kNavState;
      tangents[i] = jacobians[i] == nullptr ? nullptr : is_nav ? storage : jacobians[i];
      storage += is_nav ? factor_.rows() * kNavTangentSize : 0;
    }
    if (!factor_.Evaluate(parameters, residuals, tangents.data())) {
      return false;
    }
    for (size_t i = 0; i < blocks.size(); ++i) {
      if (blocks[i] == BlockKind::kNavState && jacobians[i] != nullptr) {
        Lift(parameters[i], tangents[i], jacobians[i]);
      }
    }
    return true;
  }

  [[nodiscard]] const Factor& factor() const { return factor_; }

  static constexpr int kMaxBlocks = 256;

 private:
  static constexpr int kStackDoubles = 640;

  void Lift(const double* block, const double* tangent, double* ambient) const {
    using Tangent = Eigen::Matrix<double, Factor::kRows, kNavTangentSize, Eigen::RowMajor>;
    using Ambient = Eigen::Matrix<double, Factor::kRows, kNavAmbientSize, Eigen::RowMajor>;
    const Eigen::Map<const Tangent> from(tangent, factor_.rows(), kNavTangentSize);
    Eigen::Map<Ambient> to(ambient, factor_.rows(), kNavAmbientSize);
    to.template leftCols<4>().noalias() = from.template leftCols<3>() * RotationLift(block);
    to.template rightCols<6>() = from.template rightCols<6>();
  }

  Factor factor_;
  int tangent_doubles_ = 0;
};

}  // namespace alidade
