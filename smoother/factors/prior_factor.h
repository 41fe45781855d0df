#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "smoother/manifold/lifted_cost.h"
#include "smoother/manifold/state_chart.h"
#include "smoother/window/column_map.h"
#include "smoother/window/window.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// Information of marginalised frames and landmarks about the remaining ones: r = r0 + J xi, unit noise, with
/// xi the stacked chart.Local(origin, state) of the frames. The Jacobian J and the origins are fixed
/// when the prior is made.
///
/// Where the prior has a spread, xi separates the scale of the window from its shape (ErrorsAt): the cameras
/// and the first velocity are brought to the scale that the window had, and the logarithm of the ratio counts
/// along the direction of the scale at the origins. Both have the same derivative at the origins. Rows of
/// vision do not concern the scale; in these coordinates they keep it undecided however scale and shape
/// change.
///
/// Columns (PriorColumns): the first frame has 15 (theta, p, v, bg, ba), every other one its pose's 6 (theta,
/// p): vision reaches only poses, and the IMU ties velocity and biases of the frame that left to those of the
/// next one alone. Once aligned with GNSS, the clock of the first frame has six more, then comes the camera's
/// calibration where it is estimated. Landmarks whose information outlives the window have three each at the
/// end, (x, y, rho) in the camera of a frame that is in the window: so they do not move with the gauge. With
/// a spread the third is rho times its ratio: then they do not move with the scale of the window either.
struct LinearPrior {
  struct Anchor {
    const WindowFrame* frame = nullptr;
    NavState origin;
    ImuBias bias_origin;  ///< used for the first frame
  };
  struct Landmark {
    std::int64_t track_id = 0;
    const WindowFrame* anchor = nullptr;
    Eigen::Vector3d origin;  ///< (x, y, rho) in the anchor's camera, on this plane of it:
    BearingPlane plane;
  };
  StateChart chart;
  std::vector<Anchor> anchors;
  std::vector<Landmark> landmarks;
  Eigen::MatrixXd jacobian;  ///< m x columns().size()
  Eigen::VectorXd residual;  ///< m, r0

  /// m, of the camera of calibration_origin when the prior was made; 0: states and landmarks as they are.
  double spread = 0;

  std::optional<Vector6d> clock_origin;
  WindowCalibration calibration_origin;  ///< with an empty layout where nothing is estimated

  /// Frames by their place among the anchors, landmarks by theirs.
  [[nodiscard]] ColumnMap columns() const;
  // Parts of xi.
  [[nodiscard]] Vector9d NavError(size_t anchor, const NavState& state) const;
  [[nodiscard]] Vector6d BiasError(const ImuBias& bias) const;     ///< of the first frame
  [[nodiscard]] Vector6d ClockError(const Vector6d& clock) const;  ///< precondition: clock_origin
  [[nodiscard]] Eigen::VectorXd CalibrationError(const CameraCalibration& camera) const;

  struct SpreadChange {
    double ratio = 1;                                ///< to the spread
    Eigen::Matrix<double, 6, Eigen::Dynamic> slope;  ///< d ln(ratio) / d (phi, dp) of each anchor's body
  };
  /// At states of all frames of the window; the slope at first estimates where there are such. Ratio 1 and
  /// slope 0 without a spread.
  [[nodiscard]] SpreadChange SpreadAt(std::span<const NavState> states) const;

  /// xi of the anchors, and how it moves with their states (zeta, canonical chart), where E puts a vector in
  /// the place of the position: d xi_i = chain_i (d zeta_i + E on_first d (phi, dp)_first) + along_i d
  /// ln(ratio).
  struct FrameErrors {
    double ratio = 1;
    std::vector<Vector9d> xi;
    std::vector<Matrix9d> chain;
    std::vector<Vector9d> along;
    Eigen::Matrix<double, 3, 6> on_first;  ///< the first anchor stays where it is: zero at ratio 1
  };
  /// kHere: derivatives at the states. kAsMade: those of the chart at xi = 0, so that directions which the
  /// prior's rows annihilate stay the same.
  enum class Derivative { kHere, kAsMade };
  /// At states of all frames of the window, with their SpreadAt.
  [[nodiscard]] FrameErrors ErrorsAt(std::span<const NavState> states, const SpreadChange& change,
                                     Derivative derivative) const;
};

/// The columns of a prior on so many frames and landmarks.
[[nodiscard]] ColumnMap PriorColumns(int frames, bool clock, int calibration, size_t landmarks = 0);

/// The prior on a first state: covariance in the canonical chart, state as the frame's blocks hold it. False
/// when the covariance is not positive definite to rounding.
bool MakeInitialPrior(ErrorConvention convention, const WindowFrame& frame, const Matrix15d& covariance,
                      LinearPrior* prior);

/// Appends what is known about the calibration, independent of all else, to a prior without landmarks that
/// has its clock already.
void AddCalibrationPrior(const CalibrationEstimate& estimate, LinearPrior* prior);

/// LinearPrior without landmarks and spread as a factor (with them: smoother/factors/slam_prior.h);
/// blocks nav and bias of the first frame, nav of the others, clock of the first, calibration.
class PriorFactor {
 public:
  static constexpr int kRows = Eigen::Dynamic;

  /// Both must outlive the factor. calibration: what the calibration's block refers to.
  PriorFactor(const LinearPrior* prior, const WindowCalibration* calibration);

  [[nodiscard]] int rows() const { return static_cast<int>(prior_->residual.size()); }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return blocks_; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  void AddFrame(size_t anchor, const double* block, double* residual, double* tangent) const;
  void AddBias(const double* block, double* residual, double* tangent) const;
  void AddClock(const double* block, double* residual, double* tangent) const;
  bool AddCalibration(const double* block, double* residual, double* tangent) const;

  const LinearPrior* prior_;
  const WindowCalibration* calibration_;
  ColumnMap columns_;
  std::vector<BlockKind> blocks_;
};

}  // namespace alidade
