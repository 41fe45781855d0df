#include "gnss/positioning/single_point.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "gnss/base/constants.h"
#include "gnss/model/measurement_model.h"
#include "gnss/positioning/robust_fit.h"
#include "gnss/positioning/velocity_fit.h"

namespace alidade {
namespace {

constexpr double kUnknownBiasM = 1e6;   // more than any receiver shows between systems
constexpr double kKnownBiasFloorM = 1;  // multipath is correlated in time: a carried bias is no better
constexpr double kRelocateM = 1;        // the troposphere changes by 0.3 mm a metre of height

}  // namespace

SinglePointSolver::SinglePointSolver(MeasurementBuilder builder, SinglePointOptions options,
                                     std::optional<Eigen::Vector3d> initial_E)
    : builder_(std::move(builder)),
      options_(options),
      gate_(options.gate_probability, 1),
      last_E_(std::move(initial_E)) {}

double SinglePointSolver::ElevationMask() const {
  return builder_.options().elevation_mask_deg * M_PI / 180;
}

double SinglePointSolver::BiasVariance(GnssSystem system, TimeNs stamp_ns) const {
  const Bias& bias = biases_[SystemIndex(system)];
  if (!bias.known) {
    return kUnknownBiasM * kUnknownBiasM;
  }
  const double elapsed = std::abs(SecondsBetween(bias.stamp_ns, stamp_ns));
  return std::max(bias.variance, kKnownBiasFloorM * kKnownBiasFloorM) +
         options_.inter_system_walk * options_.inter_system_walk * elapsed;
}

Result<SinglePointSolution> SinglePointSolver::Solve(EpochMeasurements prepared) {
  if (prepared.satellites.empty()) {
    return Status::Input(FormatGpsTime(prepared.tag_ns, 3) + ": no satellite can be used (" +
                         Describe(prepared.left_out) + ")");
  }
  SinglePointState state;
  Status status = SolveFrom(last_E_.value_or(Eigen::Vector3d::Zero()), &prepared, &state);
  if (!status.ok() && last_E_ && SolveFrom(Eigen::Vector3d::Zero(), &prepared, &state).ok()) {
    status = Status::Ok();  // the start was wrong
  }
  if (!status.ok()) {
    return Status::Input(FormatGpsTime(prepared.tag_ns, 3) + ": " + status.message());
  }
  last_E_ = state.position_E;
  datum_ = state.datum;
  CarryBiases(state, prepared.tag_ns);
  SinglePointSolution solution = MakeSolution(prepared, state);
  FitVelocity(prepared, ElevationMask(), options_, gate_, &solution);
  return solution;
}

Status SinglePointSolver::SolveFrom(const Eigen::Vector3d& start_E, EpochMeasurements* epoch,
                                    SinglePointState* state) const {
  *state = SinglePointState();
  state->position_E = start_E;
  state->active.assign(epoch->satellites.size(), true);
  if (start_E.norm() < 6e6) {  // not on the Earth: no direction, no atmosphere yet
    ALIDADE_RETURN_IF_ERROR(Iterate(*epoch, state));
  }
  const double mask = ElevationMask();
  constexpr int kMaxLocations = 6;
  for (int i = 0; i < kMaxLocations; ++i) {
    if (const double radius = state->position_E.norm(); radius < 6e6 || radius > 1e7) {
      return Status::Input(Format("the solution is %.0f m from the Earth's centre", radius));
    }
    builder_.Locate(state->position_E, epoch);
    state->located = true;
    for (std::size_t k = 0; k < epoch->satellites.size(); ++k) {
      state->active[k] = epoch->satellites[k].direction.elevation_rad >= mask;
    }
    const Eigen::Vector3d before = state->position_E;
    ALIDADE_RETURN_IF_ERROR(Iterate(*epoch, state));
    if ((state->position_E - before).norm() < kRelocateM) {
      break;
    }
  }
  Agree(*epoch, state);
  // Each satellite that goes shows others.
  constexpr int kMaxGates = 5;
  for (int i = 0; i < kMaxGates && Gate(*epoch, state); ++i) {
    ALIDADE_RETURN_IF_ERROR(Iterate(*epoch, state));
  }
  const double deviation = state->scale * std::sqrt(state->covariance.topLeftCorner<3, 3>().trace());
  return deviation <= options_.max_position_std_m
             ? Status::Ok()
             : Status::Input(
                   Format("the position's deviation is %.0f m: the geometry is too weak", deviation));
}

/// Columns of the unknowns: position, clock, then a bias for each active system but the datum.
Status SinglePointSolver::Arrange(const EpochMeasurements& epoch, SinglePointState* state) const {
  std::array<int, kGnssSystems> count{};
  int active = 0;
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    if (state->active[k]) {
      ++count[SystemIndex(epoch.satellites[k].satellite.system)];
      ++active;
    }
  }
  if (active < 4) {
    return Status::Input(Format("%d satellites can be used, expected 4 (", active) +
                         Describe(epoch.left_out) +
                         Format(", %zu below the mask or rejected)",
                                epoch.satellites.size() - static_cast<std::size_t>(active)));
  }
  std::array<int, kGnssSystems> column{};
  column.fill(-1);
  const auto first = std::find_if(count.begin(), count.end(), [](int n) { return n > 0; });
  state->datum = datum_.value_or(static_cast<GnssSystem>(first - count.begin()));
  const double moved_m =
      state->bias_m[SystemIndex(state->datum)];  // 0 unless another datum's satellites went
  state->clock_m += moved_m;
  for (double& bias_m : state->bias_m) {
    bias_m -= moved_m;
  }
  state->unknowns = 4;
  for (int i = 0; i < kGnssSystems; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (count[k] > 0 && static_cast<GnssSystem>(i) != state->datum) {
      column[k] = state->unknowns++;
    }
  }
  state->column = column;
  return Status::Ok();
}

WhitenedRows SinglePointSolver::PositionRows(const EpochMeasurements& epoch, SinglePointState* state) const {
  const auto active = std::count(state->active.begin(), state->active.end(), true);
  WhitenedRows rows;
  rows.measurements = active;
  rows.jacobian.setZero(active + state->unknowns - 4, state->unknowns);
  rows.residual.setZero(rows.jacobian.rows());
  state->residual_m.assign(epoch.satellites.size(), 0);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    const SatelliteMeasurement& m = epoch.satellites[k];
    const std::size_t system = SystemIndex(m.satellite.system);
    RowVector3d line;
    double residual = 0;
    PseudorangeModel::Of(m).Evaluate(state->position_E, state->clock_m + state->bias_m[system], &residual,
                                     &line);
    state->residual_m[k] = residual;
    if (!state->active[k]) {
      continue;
    }
    const double deviation = state->located ? std::sqrt(m.pseudorange_variance) : 1;
    rows.jacobian.block<1, 3>(row, 0) = line / deviation;
    rows.jacobian(row, 3) = 1 / deviation;
    if (state->column[system] >= 0) {
      rows.jacobian(row, state->column[system]) = 1 / deviation;
    }
    rows.residual[row++] = residual / deviation;
  }
  for (std::size_t i = 0; i < state->column.size(); ++i) {
    if (state->column[i] >= 0) {
      const double deviation = state->biases_anew
                                   ? kUnknownBiasM
                                   : std::sqrt(BiasVariance(static_cast<GnssSystem>(i), epoch.tag_ns));
      rows.jacobian(row, state->column[i]) = 1 / deviation;
      rows.residual[row++] = (state->bias_m[i] - biases_[i].mean_m) / deviation;
    }
  }
  return rows;
}

Status SinglePointSolver::Iterate(const EpochMeasurements& epoch, SinglePointState* state) const {
  ALIDADE_RETURN_IF_ERROR(Arrange(epoch, state));
  constexpr double kConvergedM = 1e-4;
  for (int i = 0; i < options_.max_iterations; ++i) {
    const WhitenedRows rows = PositionRows(epoch, state);
    // The first step has no residuals to weight by.
    const bool weighted = state->located && i > 0;
    const std::optional<RobustFit> fit =
        RobustStep(rows, options_.kernel, options_.kernel_scale_sigma, weighted);
    if (!fit) {
      return Status::Input("the satellites do not determine a position");
    }
    state->position_E += fit->step.head<3>();
    state->clock_m += fit->step[3];
    for (std::size_t k = 0; k < state->column.size(); ++k) {
      state->bias_m[k] += state->column[k] >= 0 ? fit->step[state->column[k]] : 0;
    }
    state->covariance = fit->covariance;
    if (fit->step.head<3>().norm() < kConvergedM && (weighted || !state->located)) {
      break;
    }
  }
  const WhitenedRows rows = PositionRows(epoch, state);
  std::vector<double> whitened(rows.residual.data(), rows.residual.data() + rows.measurements);
  state->scale = RobustScale(whitened, state->unknowns);
  return Status::Ok();
}

void SinglePointSolver::CarryBiases(const SinglePointState& state, TimeNs stamp_ns) {
  biases_[SystemIndex(state.datum)] = {true, 0, 0, stamp_ns};
  for (std::size_t i = 0; i < state.column.size(); ++i) {
    if (const int column = state.column[i]; column >= 0) {
      const double variance = state.scale * state.scale * state.covariance(column, column);
      biases_[i] = {true, state.bias_m[i], variance, stamp_ns};
    }
  }
}

SinglePointSolution SinglePointSolver::MakeSolution(const EpochMeasurements& epoch,
                                                    const SinglePointState& state) const {
  SinglePointSolution solution;
  solution.tag_ns = epoch.tag_ns;
  solution.stamp_ns = epoch.tag_ns - SecondsToNs(state.clock_m / kSpeedOfLight);
  solution.position_E = state.position_E;
  solution.scale = state.scale;
  solution.position_covariance_E = state.scale * state.scale * state.covariance.topLeftCorner<3, 3>();
  solution.clock_m = state.clock_m;
  for (std::size_t i = 0; i < state.column.size(); ++i) {
    if (state.column[i] >= 0) {
      solution.inter_system_bias_m[i] = state.bias_m[i];
    }
  }
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    const SatelliteMeasurement& m = epoch.satellites[k];
    solution.satellites.push_back({m.satellite, m.direction, state.residual_m[k],
                                   std::sqrt(m.pseudorange_variance), state.active[k], std::nullopt, false});
    solution.used += state.active[k] ? 1 : 0;
  }
  return solution;
}

}  // namespace alidade
