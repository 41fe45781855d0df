#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/robust.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/robust_fit.h"

namespace alidade {

/// Settings of the single-point solution.
struct SinglePointOptions {
  RobustKernel kernel = RobustKernel::kHuber;
  double kernel_scale_sigma = 1.5;
  double gate_probability = 0.999;
  double inter_system_walk = 0.05;  ///< [m / sqrt(s)]
  double max_position_std_m = 300;
  int max_iterations = 30;

  void Describe(ConfigVisitor& visitor);
};

/// Position and velocity of the antenna from one epoch.
struct SinglePointSolution {
  TimeNs tag_ns = 0;    ///< the receiver's tag
  TimeNs stamp_ns = 0;  ///< true GPST: tag - clock
  Eigen::Vector3d position_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d position_covariance_E = Eigen::Matrix3d::Zero();
  bool has_velocity = false;
  Eigen::Vector3d velocity_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d velocity_covariance_E = Eigen::Matrix3d::Zero();
  double clock_m = 0;  ///< c dt_r against the datum system (GPS unless the first epoch had none)
  double drift_mps = 0;
  /// Bias of a system's clock against the datum [m]; empty where it had no satellite.
  std::array<std::optional<double>, kGnssSystems> inter_system_bias_m;
  std::vector<SatelliteResidual> satellites;
  int used = 0;
  double scale = 1;  ///< robust deviation of whitened residuals; the covariance holds its square
};

/// Solves epochs one by one. The unknowns are position, one receiver clock and a bias for each further
/// system; the biases alone are carried on. Robust: Huber weights, what most satellites agree on where those
/// fail, then a chi-square gate on each satellite.
class SinglePointSolver {
 public:
  /// `initial_E`: where to start, such as the approximate position of a file; not trusted.
  SinglePointSolver(MeasurementBuilder builder, SinglePointOptions options,
                    std::optional<Eigen::Vector3d> initial_E = std::nullopt);

  /// Errors (kInput): too few satellites with ephemerides above the mask, or a weak geometry, in words.
  Result<SinglePointSolution> Solve(const ObservationEpoch& epoch);

  /// Further epochs are prepared with this one, such as when newer ephemerides came in.
  void SetBuilder(MeasurementBuilder builder) { builder_ = std::move(builder); }

 private:
  struct Bias {
    bool known = false;
    double mean_m = 0;
    double variance = 0;
    TimeNs stamp_ns = 0;
  };
  struct State;

  [[nodiscard]] Status SolveFrom(const Eigen::Vector3d& start_E, EpochMeasurements* epoch,
                                 State* state) const;
  [[nodiscard]] Status Arrange(const EpochMeasurements& epoch, State* state) const;
  [[nodiscard]] WhitenedRows PositionRows(const EpochMeasurements& epoch, State* state) const;
  [[nodiscard]] Status Iterate(const EpochMeasurements& epoch, State* state) const;
  void Agree(const EpochMeasurements& epoch, State* state) const;
  [[nodiscard]] bool Gate(const EpochMeasurements& epoch, State* state) const;
  [[nodiscard]] double ElevationMask() const;
  [[nodiscard]] double BiasVariance(GnssSystem system, TimeNs stamp_ns) const;
  void CarryBiases(const State& state, TimeNs stamp_ns);
  [[nodiscard]] SinglePointSolution MakeSolution(const EpochMeasurements& epoch, const State& state) const;

  MeasurementBuilder builder_;
  SinglePointOptions options_;
  ChiSquareGate gate_;
  std::optional<Eigen::Vector3d> last_E_;
  std::optional<GnssSystem> datum_;
  std::array<Bias, kGnssSystems> biases_;
};

}  // namespace alidade
