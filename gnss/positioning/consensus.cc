#include "gnss/positioning/consensus.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/robust.h"

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

/// Least squares over the measurements that agree with the fit: a sample alone has the noise of few.
void FitAgreeing(const WhitenedRows& rows, Consensus* consensus) {
  constexpr int kFits = 10;
  for (int k = 0; k < kFits; ++k) {
    std::vector<Eigen::Index> agreeing;
    for (Eigen::Index i = 0; i < rows.measurements; ++i) {
      if (consensus->Agrees(i)) {
        agreeing.push_back(i);
      }
    }
    const Eigen::MatrixXd jacobian = rows.jacobian(agreeing, Eigen::all);
    const Eigen::VectorXd residual = rows.residual(agreeing);
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian);
    const auto spare = static_cast<double>(agreeing.size()) - static_cast<double>(jacobian.cols());
    if (qr.rank() < jacobian.cols() || spare < 1) {
      return;
    }
    consensus->step = qr.solve(-residual);
    consensus->residual =
        rows.residual.head(rows.measurements) + rows.jacobian.topRows(rows.measurements) * consensus->step;
    consensus->spread = (residual + jacobian * consensus->step).norm() / std::sqrt(spare);
  }
}

}  // namespace

bool Consensus::Agrees(Eigen::Index measurement) const {
  constexpr double kSigma = 4;
  return std::abs(residual[measurement]) < kSigma * std::max(1.0, spread);
}

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
  // The sample is among those that agree, so that nearly half of all measurements may be wrong; but of the
  // others a third agrees, which few do by chance.
  const Eigen::Index spare = count - unknowns;
  const Eigen::Index agree = std::max(count / 2 - unknowns, spare / 3) + 1;
  const auto last = others + (agree - 1);
  const double normal =
      std::sqrt(ChiSquareQuantile(1, static_cast<double>(agree) / static_cast<double>(spare)));
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
    std::nth_element(others, last, order.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return std::abs(left[a]) < std::abs(left[b]); });
    const double spread = std::abs(left[*last]) / normal;
    if (!best || spread < best->spread) {
      best = {step, spread, left};
    }
  }
  if (best) {
    FitAgreeing(rows, &*best);
  }
  return best;
}

}  // namespace alidade
