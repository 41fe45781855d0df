#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/robust.h"
#include "core/time.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/robust_fit.h"
#include "gnss/positioning/single_point_options.h"
#include "gnss/positioning/single_point_solution.h"
#include "gnss/positioning/single_point_state.h"

namespace alidade {

/// Solves epochs one by one. The unknowns are position, one receiver clock and a bias for each further
/// system; the biases alone are carried on. Robust: Huber weights, what most satellites agree on where those
/// fail, then a chi-square gate on each satellite.
class SinglePointSolver {
 public:
  /// `initial_E`: where to start, such as the approximate position of a file; not trusted.
  SinglePointSolver(MeasurementBuilder builder, SinglePointOptions options,
                    std::optional<Eigen::Vector3d> initial_E = std::nullopt);

  /// `prepared`: by the solver's own builder (or an equal one). Errors (kInput): too few satellites with
  /// ephemerides above the mask, or a weak geometry, in words.
  Result<SinglePointSolution> Solve(EpochMeasurements prepared);
  /// The same of an epoch that is not prepared yet.
  Result<SinglePointSolution> Solve(const ObservationEpoch& epoch) { return Solve(builder_.Prepare(epoch)); }

  /// Further epochs are prepared with this one, such as when newer ephemerides came in.
  void SetBuilder(MeasurementBuilder builder) { builder_ = std::move(builder); }

 private:
  struct Bias {
    bool known = false;
    double mean_m = 0;
    double variance = 0;
    TimeNs stamp_ns = 0;
  };

  [[nodiscard]] Status SolveFrom(const Eigen::Vector3d& start_E, EpochMeasurements* epoch,
                                 SinglePointState* state) const;
  [[nodiscard]] Status Arrange(const EpochMeasurements& epoch, SinglePointState* state) const;
  [[nodiscard]] WhitenedRows PositionRows(const EpochMeasurements& epoch, SinglePointState* state) const;
  [[nodiscard]] Status Iterate(const EpochMeasurements& epoch, SinglePointState* state) const;
  void Agree(const EpochMeasurements& epoch, SinglePointState* state) const;
  [[nodiscard]] bool Gate(const EpochMeasurements& epoch, SinglePointState* state) const;
  [[nodiscard]] double ElevationMask() const;
  [[nodiscard]] double BiasVariance(GnssSystem system, TimeNs stamp_ns) const;
  void CarryBiases(const SinglePointState& state, TimeNs stamp_ns);
  [[nodiscard]] SinglePointSolution MakeSolution(const EpochMeasurements& epoch,
                                                 const SinglePointState& state) const;

  MeasurementBuilder builder_;
  SinglePointOptions options_;
  ChiSquareGate gate_;
  std::optional<Eigen::Vector3d> last_E_;
  std::optional<GnssSystem> datum_;
  std::array<Bias, kGnssSystems> biases_;
};

}  // namespace alidade
