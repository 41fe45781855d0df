#include "gnss/positioning/consensus.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace alidade {
namespace {

constexpr int kSamples = 200;  // a third of reflections leaves one sample of seven in seventeen clean
constexpr Eigen::Index kSpare = 6;

/// Order of the measurements: one of every group first, the rest at random.
void Draw(const std::vector<int>& group, RandomStream* random, std::vector<Eigen::Index>* order) {
  random->Shuffle(order);
  std::vector<bool> seen;
  std::stable_partition(order->begin(), order->end(), [&](Eigen::Index i) {
    const auto g = static_cast<std::size_t>(group[static_cast<std::size_t>(i)]);
    seen.resize(std::max(seen.size(), g + 1));
    const bool first = !seen[g];
    seen[g] = true;
    return first;
  });
}

}  // namespace

std::optional<Consensus> SeekConsensus(const WhitenedRows& rows, const std::vector<int>& group) {
  const Eigen::Index unknowns = rows.jacobian.cols();
  const Eigen::Index count = rows.measurements;
  if (count < unknowns + kSpare) {
    return std::nullopt;
  }
  const auto jacobian = rows.jacobian.topRows(count);
  const auto residual = rows.residual.head(count);
  RandomStream random(1, "gnss.consensus");
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<Eigen::Index>(i);
  }
  const auto others = order.begin() + unknowns;
  const auto middle = others + (count - unknowns - 1) / 2;
  std::optional<Consensus> best;
  for (int k = 0; k < kSamples; ++k) {
    Draw(group, &random, &order);
    const std::vector<Eigen::Index> sample(order.begin(), others);
    const Eigen::MatrixXd square = jacobian(sample, Eigen::all);
    const Eigen::VectorXd right = residual(sample);
    const Eigen::VectorXd step = square.partialPivLu().solve(-right);
    const Eigen::VectorXd left = residual + jacobian * step;
    if (!left.allFinite()) {  // a sample without a solution
      continue;
    }
    std::nth_element(others, middle, order.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return std::abs(left[a]) < std::abs(left[b]); });
    const double spread = 1.4826 * std::abs(left[*middle]);
    if (!best || spread < best->spread) {
      best = {step, spread, left};
    }
  }
  return best;
}

}  // namespace alidade
