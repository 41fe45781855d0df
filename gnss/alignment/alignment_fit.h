#pragma once

#include <Eigen/Core>
#include <vector>

#include "gnss/model/epoch_rows.h"

namespace alidade {

/// The estimate in the local world at one time.
struct AlignmentState {
  TimeNs stamp_ns = 0;
  NavState nav;
  ImuBias bias;
  Eigen::Vector3d gyro_radps = Eigen::Vector3d::Zero();
  Eigen::Matrix3d velocity_covariance_W = Eigen::Matrix3d::Zero();
  Eigen::Vector3d acceleration_W = Eigen::Vector3d::Zero();
  Eigen::Matrix3d position_covariance_W = Eigen::Matrix3d::Zero();
};

/// An epoch with the estimate at its time.
struct AlignmentSample {
  AlignmentState state;
  EpochMeasurements measurements;  ///< located
};

/// Values of the unknowns: how W stands in N, what time the epochs are off, what velocity the estimate is
/// off, and the receiver's clock.
struct AlignmentGuess {
  /// All zero, at this yaw and shift, with `samples` clocks that nothing is known of.
  AlignmentGuess(double yaw, const Eigen::Vector3d& shift, std::size_t samples);

  double yaw_rad = 0;
  Eigen::Vector3d p_NW = Eigen::Vector3d::Zero();
  double time_offset_s = 0;
  Eigen::Vector3d dv_W =
      Eigen::Vector3d::Zero();         ///< to be added to all velocities, and in time to positions
  Vector6d biases = Vector6d::Zero();  ///< of systems, by ClockState's index
  std::vector<double> clock_m;         ///< by sample
  std::vector<double> drift_mps;
  std::vector<bool> clock_known;
};

/// What a step saw at the guess it started from.
struct AlignmentStep {
  bool ok = false;   ///< false: the samples do not determine the unknowns
  double cost = 0;   ///< robust
  double scale = 1;  ///< robust deviation of the whitened residuals
  /// Of (yaw, p_NW): the inverse of the normal equations.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

/// Robust least squares over the unknowns of AlignmentGuess, one Gauss-Newton step at a time: every
/// pseudorange and range rate, the process of the clock between epochs (not across its jumps), and wide
/// priors.
class AlignmentFit {
 public:
  struct Options {
    bool yaw_free = true;   ///< and the time offset, where it is estimated
    bool robust = true;     ///< the weights of gnss.robust_kernel
    double gate_sigma = 0;  ///< rows beyond have no weight
  };

  AlignmentFit(const GnssConfig& config, const AntennaMount& mount,
               std::vector<const AlignmentSample*> samples);

  /// Moves the guess by one step.
  [[nodiscard]] AlignmentStep Step(const Options& options, AlignmentGuess* guess) const;
  [[nodiscard]] const std::vector<const AlignmentSample*>& samples() const { return samples_; }

 private:
  class NormalEquations;
  struct Epoch;

  /// Epochs in the time over which the estimate's velocity error stays the same.
  [[nodiscard]] double EpochsOfOneError() const;
  [[nodiscard]] Epoch Linearize(std::size_t index, AlignmentGuess* guess) const;
  void AddEpoch(std::size_t index, const Options& options, AlignmentGuess* guess, NormalEquations* system,
                AlignmentStep* step, std::vector<double>* whitened) const;
  void AddClockProcess(const AlignmentGuess& guess, NormalEquations* system) const;
  void AddPriors(const Options& options, const AlignmentGuess& guess, NormalEquations* system) const;
  void Move(const Eigen::VectorXd& step, AlignmentGuess* guess) const;

  GnssConfig config_;
  AntennaMount mount_;
  std::vector<const AlignmentSample*> samples_;
};

}  // namespace alidade
