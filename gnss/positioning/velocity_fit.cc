#include "gnss/positioning/velocity_fit.h"

#include <cmath>

#include "gnss/model/measurement_model.h"
#include "gnss/positioning/robust_fit.h"

namespace alidade {
namespace {

constexpr int kUnknowns = 4;

/// Whitened rows of the chosen satellites at the present velocity and drift.
WhitenedRows VelocityRows(const EpochMeasurements& epoch, const std::vector<std::size_t>& chosen,
                          SinglePointSolution* solution) {
  WhitenedRows rows;
  rows.measurements = static_cast<Eigen::Index>(chosen.size());
  rows.jacobian.setZero(rows.measurements, kUnknowns);
  rows.residual.setZero(rows.measurements);
  for (Eigen::Index row = 0; row < rows.measurements; ++row) {
    const std::size_t k = chosen[static_cast<std::size_t>(row)];
    const double deviation = std::sqrt(epoch.satellites[k].range_rate_variance);
    RowVector3d line;
    double residual = 0;
    RangeRateModel::Of(epoch.satellites[k])
        .Evaluate(solution->position_E, solution->velocity_E, solution->drift_mps, &residual, nullptr, &line);
    rows.jacobian.row(row) << line / deviation, 1 / deviation;
    rows.residual[row] = residual / deviation;
    solution->satellites[k].range_rate_residual_mps = residual;
  }
  return rows;
}

/// Steps until they are small; `rows` are those of the last step. False when the unknowns are not determined.
bool Converge(const EpochMeasurements& epoch, const std::vector<std::size_t>& chosen,
              const SinglePointOptions& options, SinglePointSolution* solution, WhitenedRows* rows) {
  constexpr double kConvergedMps = 1e-6;
  for (int i = 0; i < options.max_iterations; ++i) {
    *rows = VelocityRows(epoch, chosen, solution);
    const std::optional<RobustFit> fit = RobustStep(*rows, options.kernel, options.kernel_scale_sigma, i > 0);
    if (!fit) {
      return false;
    }
    solution->velocity_E += fit->step.head<3>();
    solution->drift_mps += fit->step[3];
    solution->velocity_covariance_E = fit->covariance.topLeftCorner<3, 3>();
    if (i > 0 && fit->step.norm() < kConvergedMps) {
      break;
    }
  }
  *rows = VelocityRows(epoch, chosen, solution);
  return true;
}

double Scale(const WhitenedRows& rows) {
  return RobustScale({rows.residual.data(), rows.residual.data() + rows.measurements}, kUnknowns);
}

}  // namespace

void FitVelocity(const EpochMeasurements& epoch, double elevation_mask_rad, const SinglePointOptions& options,
                 const ChiSquareGate& gate, SinglePointSolution* solution) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    const SatelliteMeasurement& m = epoch.satellites[k];
    if (m.range_rate_mps && m.direction.elevation_rad >= elevation_mask_rad) {
      chosen.push_back(k);
    }
  }
  WhitenedRows rows;
  if (!Converge(epoch, chosen, options, solution, &rows)) {
    return;
  }
  const double scale = Scale(rows);
  std::vector<std::size_t> kept;
  for (Eigen::Index row = 0; row < rows.measurements; ++row) {
    if (gate.Accepts(rows.residual[row] * rows.residual[row] / (scale * scale), 1)) {
      kept.push_back(chosen[static_cast<std::size_t>(row)]);
    }
  }
  if (kept.size() > kUnknowns && kept.size() < chosen.size()) {
    chosen = kept;
    if (!Converge(epoch, chosen, options, solution, &rows)) {
      return;
    }
  }
  const double final_scale = Scale(rows);
  solution->has_velocity = true;
  solution->velocity_covariance_E *= final_scale * final_scale;
  for (const std::size_t k : chosen) {
    solution->satellites[k].range_rate_used = true;
  }
}

}  // namespace alidade
