#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/calibration.h"
#include "gnss/model/epoch_rows.h"
#include "gnss/model/receiver_clock.h"
#include "smoother/manifold/lifted_cost.h"
#include "smoother/window/frame_epoch.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// What the factors of a window's epochs share.
struct GnssFactorContext {
  GnssConfig config;
  AntennaMount mount;
  Eigen::Vector3d gravity_W = Eigen::Vector3d::Zero();
};

/// The rows of an epoch, whitened, over the frame's 15 canonical coordinates and its clock. Rows that the
/// gate refused are zero.
struct FrameEpochRows {
  Eigen::Matrix<double, Eigen::Dynamic, 15> frame;
  Eigen::Matrix<double, Eigen::Dynamic, 6> clock;
  Eigen::Matrix<double, Eigen::Dynamic, 3> lever_arm;
  Eigen::VectorXd residual;
  std::vector<double> information;  ///< GnssRow::information; of one that is refused 1
  std::vector<bool> contradicted;   ///< GnssRow
};
/// `robust`: as a factor has the rows, with their information and the kernel, which acts as a residual whose
/// square is the kernel's cost. Otherwise as they are gated.
[[nodiscard]] FrameEpochRows LinearizeFrameEpoch(const GnssFactorContext& context, const FrameEpoch& epoch,
                                                 double dt_s, const NavState& nav, const ImuBias& bias,
                                                 const Vector6d& clock, bool robust,
                                                 GnssResiduals* residuals);

/// An epoch as a factor over blocks nav, bias and clock of its frame, and the calibration where that has the
/// antenna's lever arm.
class GnssEpochFactor {
 public:
  static constexpr int kRows = Eigen::Dynamic;

  /// All must outlive the factor; `rows` is what LinearizeFrameEpoch gives for them.
  GnssEpochFactor(const GnssFactorContext* context, const FrameEpoch* epoch, double dt_s, int rows,
                  const CalibrationLayout& layout = NotCalibrated().layout)
      : context_(context), epoch_(epoch), dt_s_(dt_s), rows_(rows), layout_(&layout) {}

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] std::span<const BlockKind> blocks() const {
    return std::span(kBlocks).first(sees_calibration() ? 4 : 3);
  }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 4> kBlocks = {BlockKind::kNavState, BlockKind::kBias,
                                                       BlockKind::kClock, BlockKind::kCalibration};
  [[nodiscard]] bool sees_calibration() const { return layout_->antenna() == Sensor::kGnss; }
  const GnssFactorContext* context_;
  const FrameEpoch* epoch_;
  double dt_s_;
  int rows_;
  const CalibrationLayout* layout_;
};

/// The clock's process between two frames, whitened: residual = root (c_j - phi c_i).
struct ClockStep {
  /// `anew`: the clock was lost between them, as at a jump that is not of whole milliseconds.
  ClockStep(const GnssConfig& config, double dt_s, bool anew);

  Matrix6d phi;
  Matrix6d root;
};

class ClockFactor {
 public:
  static constexpr int kRows = 6;

  explicit ClockFactor(const ClockStep& step) : step_(step) {}

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 2> kBlocks = {BlockKind::kClock, BlockKind::kClock};
  ClockStep step_;
};

}  // namespace alidade
