#pragma once

#include <array>
#include <memory>
#include <span>

#include "core/landmark_solver.h"
#include "smoother/factors/geometry_cache.h"
#include "smoother/manifold/lifted_cost.h"
#include "smoother/window/window.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// One observation of a landmark (x, y, rho) anchored in another frame: LinearizeAnchoredView without a
/// kernel. Blocks nav_base, nav_view, landmark and the camera's calibration; 2 rows.
///
/// The base bearing (x, y) is a measurement like any other, so it is estimated too and BaseBearingFactor
/// holds it to the base observation: base noise is then accounted for exactly, correlation between the views
/// of a track included. (Holding it fixed, as VINS-Mono does, counts the common error of a track as
/// information.)
class InverseDepthFactor {
 public:
  static constexpr int kRows = 2;

  /// All must outlive the factor. `plane` and `base_row_px`: of the base's observation. `cache`: that it
  /// shares with other factors; null: its own.
  InverseDepthFactor(const WindowFrame* base, const WindowView* view, const WindowCalibration* calibration,
                     const BearingPlane& plane = kNormalizedPlane, double base_row_px = 0,
                     GeometryCache* cache = nullptr);

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  /// Behind the view the residual is replaced by a large constant with zero Jacobians, so that a trial step
  /// of the solver is refused rather than the whole solve failing. False: the calibration block is no camera.
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 4> kBlocks = {BlockKind::kNavState, BlockKind::kNavState,
                                                       BlockKind::kLandmark, BlockKind::kCalibration};
  const WindowFrame* base_;
  const WindowView* view_;
  const WindowCalibration* calibration_;
  BearingPlane plane_;
  double base_row_px_;
  GeometryCache* cache_;
  std::shared_ptr<GeometryCache> own_;
};

/// The base observation of an inverse-depth landmark: W ((x, y) - z), both on its plane. Blocks landmark and
/// the camera's calibration; 2 rows.
class BaseBearingFactor {
 public:
  static constexpr int kRows = 2;

  /// Both must outlive the factor.
  BaseBearingFactor(const WindowView* view, const WindowCalibration* calibration);

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 2> kBlocks = {BlockKind::kLandmark, BlockKind::kCalibration};
  const WindowView* view_;
  const WindowCalibration* calibration_;
};

/// The weak prior on the inverse depth of a track without parallax. Block landmark; 1 row.
class DepthPriorFactor {
 public:
  static constexpr int kRows = 1;

  explicit DepthPriorFactor(const DepthPrior& prior) : prior_(prior) {}

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 1> kBlocks = {BlockKind::kLandmark};
  DepthPrior prior_;
};

}  // namespace alidade
