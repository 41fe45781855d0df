#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "smoother/manifold/lifted_cost.h"
#include "smoother/tracks/track_system.h"

namespace alidade {

/// All pose-only tracks of a window as ONE factor over the frames' navigation states. Variable projection: at
/// every evaluation each landmark is solved for given the poses (SolveLandmark), so the cost is
///
///     F(X) = min_f  sum over tracks and views of rho(|W (pi(X, f) - z)|^2) / 2.
///
/// Exactness. dF/dX needs no derivative of f (it is stationary: envelope theorem), so the gradient J^T r is
/// exact. J^T J is H^T N N^T H with N the left null space of the point Jacobian: Kaufman's form of variable
/// projection (BIT 15, 1975), the Gauss-Newton matrix of the full bundle adjustment after elimination of its
/// landmarks. (Golub and Pereyra's extra term is of the size of the residual times the curvature, as what
/// Gauss-Newton drops anyway.) Minimum and covariance are therefore those of the explicit landmarks of
/// InverseDepthFactor; what differs is the path to it.
///
/// Ceres uses a residual only through r^T r, J^T r and J^T J. All tracks together inform 6F pose coordinates,
/// so their rows are handed over as the equivalent 6F rows of a square root, and one last row with zero
/// Jacobian that holds the rest of the cost. Where no Jacobian is asked for, as at a trial step, the last row
/// holds all of it: nothing is linearised for a step that may not be taken.
class PoseOnlyFactor {
 public:
  static constexpr int kRows = Eigen::Dynamic;

  /// `tracks` have landmarks to start from; they, the window and the calibration, whose block comes last,
  /// must outlive the factor.
  PoseOnlyFactor(const Window& window, std::vector<const WindowTrack*> tracks,
                 const WindowCalibration& calibration, const ObservationKernel& kernel);

  [[nodiscard]] int rows() const {
    return static_cast<int>(kPoseColumns) * frames_ + calibration_->size() + 1;
  }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return blocks_; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  /// Ceres asks for the residual of a trial step and, if it takes the step, for residual and Jacobian at the
  /// same point. The first gives the landmarks and the cost, the second the rows.
  struct Memo {
    std::vector<double> parameters;
    WindowCalibration camera;
    std::vector<FrameGeometry> geometry;
    std::vector<std::optional<Eigen::Vector3d>> landmarks;  ///< of each track; none behind a view
    double robust_cost = 0;
    bool linear = false;  ///< jacobian and residual are of these parameters
    ColumnMap columns;    ///< of jacobian
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd residual;
    TrackWorkspace workspace;
  };
  /// False when the calibration block is no camera.
  bool SolveLandmarks(const double* const* parameters) const;
  void Linearize() const;

  const Window* window_;
  int frames_;
  const WindowCalibration* calibration_;
  std::vector<const WindowTrack*> tracks_;
  ObservationKernel kernel_;
  std::vector<BlockKind> blocks_;
  std::unique_ptr<Memo> memo_;
};

}  // namespace alidade
