#include "filter/clone_conditional.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace alidade {
namespace {

using Eigen::Index;

// A memory shares each of w's directions with this part of the others.
constexpr double kPoseDirections = 6;

constexpr size_t kMost = CloneConditional::kMaxNeighbours;
constexpr int kMostRows = 6 * CloneConditional::kMaxNeighbours;
using Joint = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;

/// Indices of `count` of the other clones, by their distance from `index` in time: the nearest first, then at
/// ranks that grow geometrically up to the farthest.
std::array<size_t, kMost> SpreadClones(size_t clones, size_t index, size_t count) {
  std::array<size_t, kMost> chosen{};
  const double step = count > 1 ? std::pow(clones - 1, 1.0 / static_cast<double>(count - 1)) : 1;
  size_t taken = 0;
  for (size_t rank = 1, before = index, after = index + 1; taken < count; ++rank) {
    const bool earlier = before > 0 && (after == clones || index - before < after - index);
    const size_t next = earlier ? --before : after++;
    const auto wanted = static_cast<size_t>(std::lround(std::pow(step, taken)));
    if (rank >= std::max(taken + 1, wanted)) {
      chosen[taken++] = next;
    }
  }
  return chosen;
}

/// Covariance of (x_m, x_2, x_3 ...), less x_1 each: what follows does not depend on their common position.
Joint RelativeCovariance(const FilterState& state, size_t leaving,
                         const std::array<size_t, kMost>& neighbours, size_t count) {
  const SquareRootCovariance& covariance = state.covariance();
  const auto offset = [&](size_t i) { return state.CloneOffset(i == 0 ? leaving : neighbours[i]); };
  const int first = state.CloneOffset(neighbours[0]);
  const Matrix6d of_first = covariance.PoseBlock(first, first);
  std::array<Matrix6d, kMost> with_first;
  for (size_t i = 0; i < count; ++i) {
    with_first[i] = covariance.PoseBlock(offset(i), first);
  }
  Joint p(6 * count, 6 * count);
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j <= i; ++j) {
      const Matrix6d block =
          covariance.PoseBlock(offset(i), offset(j)) - with_first[i] - with_first[j].transpose() + of_first;
      p.block<6, 6>(6 * static_cast<Index>(i), 6 * static_cast<Index>(j)) = block;
      p.block<6, 6>(6 * static_cast<Index>(j), 6 * static_cast<Index>(i)) = block.transpose();
    }
  }
  return p;
}

}  // namespace

void ConditionClone(const FilterState& state, size_t index, size_t memories, CloneConditional* conditional) {
  const std::vector<Clone>& clones = state.clones();
  CHECK_GE(clones.size(), 3U);
  const size_t count = std::min(kMost, clones.size() - 1);
  const std::array<size_t, kMost> neighbours = SpreadClones(clones.size(), index, count);
  const Joint p = RelativeCovariance(state, index, neighbours, count);
  const Index others = p.rows() - 6;
  const Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMostRows, 6> gain =
      p.bottomRightCorner(others, others).ldlt().solve(p.bottomLeftCorner(others, 6));
  conditional->leaving_serial = clones[index].serial;
  conditional->leaving_slot = clones[index].slot;
  conditional->neighbours = count;
  auto over_first = conditional->gain.leftCols<6>();
  over_first.setIdentity();
  conditional->neighbour_slots[0] = clones[neighbours[0]].slot;
  for (size_t i = 1; i < count; ++i) {
    conditional->neighbour_slots[i] = clones[neighbours[i]].slot;
    const Matrix6d part = gain.middleRows<6>(6 * static_cast<Index>(i - 1)).transpose();
    conditional->gain.middleCols<6>(6 * static_cast<Index>(i)) = part;
    over_first -= part;
  }
  const Matrix6d rest = p.topLeftCorner<6, 6>() - gain.transpose() * p.bottomLeftCorner(others, 6);
  conditional->covariance =
      std::max(1.0, static_cast<double>(memories) / kPoseDirections) * 0.5 * (rest + rest.transpose());
}

}  // namespace alidade
