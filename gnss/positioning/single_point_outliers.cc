#include <algorithm>
#include <cmath>

#include "gnss/positioning/consensus.h"
#include "gnss/positioning/single_point.h"

namespace alidade {

/// Many reflections, which are all late, pull Huber's minimum by metres, where good satellites look no better
/// than they. Where the residuals are far larger than their deviations and most satellites agree far better
/// elsewhere, those that do are fitted.
void SinglePointSolver::Agree(const EpochMeasurements& epoch, SinglePointState* state) const {
  constexpr double kSuspiciousScale = 1.5;
  constexpr double kBetter = 0.5;
  if (state->scale < kSuspiciousScale) {
    return;
  }
  SinglePointState other = *state;
  const WhitenedRows rows = PositionRows(epoch, &other);
  std::vector<int> group;
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    if (other.active[k]) {
      group.push_back(other.column[SystemIndex(epoch.satellites[k].satellite.system)] + 1);
    }
  }
  const std::optional<Consensus> consensus = SeekConsensus(rows, group);
  if (!consensus || consensus->spread > kBetter * state->scale) {
    return;
  }
  Eigen::Index row = 0;
  Eigen::Index agreeing = 0;
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    if (other.active[k]) {
      other.active[k] = consensus->Agrees(row++);
      agreeing += other.active[k] ? 1 : 0;
    }
  }
  if (2 * agreeing <= rows.measurements) {
    return;
  }
  other.biases_anew = true;
  if (Iterate(epoch, &other).ok()) {
    *state = other;
  }
}

/// Takes out satellites beyond the gate, the worst first as long as the rest has one to spare; true if any.
bool SinglePointSolver::Gate(const EpochMeasurements& epoch, SinglePointState* state) const {
  std::vector<std::pair<double, std::size_t>> refused;
  for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
    const double squared = state->residual_m[k] * state->residual_m[k] /
                           (epoch.satellites[k].pseudorange_variance * state->scale * state->scale);
    if (state->active[k] && !gate_.Accepts(squared, 1)) {
      refused.emplace_back(-squared, k);
    }
  }
  std::sort(refused.begin(), refused.end());
  auto left = std::count(state->active.begin(), state->active.end(), true);
  bool any = false;
  for (const auto& [squared, k] : refused) {
    if (left > state->unknowns + 1) {
      state->active[k] = false;
      --left;
      any = true;
    }
  }
  return any;
}

}  // namespace alidade
