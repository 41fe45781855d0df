#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/robust.h"
#include "smoother/truth/truth_start.h"

namespace alidade {

/// Noise of recorded poses: standard deviation of one component, the same for all.
struct TruthNoise {
  double orientation_rad = 0;
  double position_m = 0;
};

/// Sum of squared whitened residuals of one kind at the estimate, and its expectation: the rows less what the
/// estimate follows them (sum of the diagonal of the hat matrix over the rows). Their ratio is 1 where the
/// noise is as assumed; its square root is the factor by which it is too small.
struct TruthFit {
  double chi_square = 0;
  double dof = 0;
  [[nodiscard]] double ratio() const { return dof > 0 ? chi_square / dof : 0; }
};

/// A time in IMU time.
struct TruthSpan {
  TimeNs from_ns = 0;
  TimeNs to_ns = 0;
};

/// A recorded pose in a refinement.
struct GatedPose {
  TruthPose pose;
  std::optional<size_t> state;           ///< IMU sample before it; empty outside the samples
  bool passes = true;                    ///< the gate
  Vector6d residual = Vector6d::Zero();  ///< (orientation, position) [rad, m] at the present states

  [[nodiscard]] bool used() const { return state.has_value() && passes; }
};

/// The poses of a refinement, which of them are used, and their noise.
class TruthPoses {
 public:
  /// A positive deviation of `given` is taken as it is, else it is estimated.
  TruthPoses(std::span<const TruthPose> poses, double gate_probability, const TruthNoise& given);

  [[nodiscard]] std::vector<GatedPose>& poses() { return poses_; }
  [[nodiscard]] const std::vector<GatedPose>& poses() const { return poses_; }
  [[nodiscard]] const TruthNoise& noise() const { return noise_; }
  /// What is not given.
  void SetNoise(const TruthNoise& noise) {
    noise_ = noise;
    TakeGivenNoise();
  }

  /// Each pose to the sample before it in IMU time.
  void Attach(std::span<const ImuSample> imu, double time_offset_s);

  /// Weight in (0, 1] of a residual (Huber).
  [[nodiscard]] double RobustWeightOf(const Vector6d& residual) const;

  // At the present residuals:

  /// Noise from the medians over all poses.
  void EstimateRobustNoise();
  /// Refuses the poses beyond the gate and takes the others; the number of verdicts that changed.
  size_t Gate();
  /// The fit of the poses that are used, and the noise of maximum likelihood from it. `hat`: sums of the
  /// diagonal of J P J^T over their rows [rad^2, m^2], J of the residuals and P the covariance of the
  /// unknowns.
  void EstimateNoise(const TruthNoise& hat);
  [[nodiscard]] const TruthFit& orientation() const { return orientation_; }
  [[nodiscard]] const TruthFit& position() const { return position_; }

  /// 1 + 2 sum of the autocorrelation of the residuals of orientation, or position, up to where it falls
  /// below 0.05.
  [[nodiscard]] double OrientationCorrelation() const { return Correlation(0); }
  [[nodiscard]] double PositionCorrelation() const { return Correlation(3); }
  /// Between successive poses that are used, where they are farther apart.
  [[nodiscard]] std::vector<TruthSpan> Gaps(double longer_than_s, double time_offset_s) const;
  /// From the first to the last pose that is used.
  [[nodiscard]] TruthSpan Extent(double time_offset_s) const;

 private:
  [[nodiscard]] double Correlation(int row) const;
  void TakeGivenNoise();

  std::vector<GatedPose> poses_;
  ChiSquareGate gate_;
  TruthNoise given_;
  TruthNoise noise_;
  TruthFit orientation_, position_;
};

}  // namespace alidade
