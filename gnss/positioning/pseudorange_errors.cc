#include "gnss/positioning/pseudorange_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace alidade {
namespace {

constexpr int kUnknowns = 4;      // position and clock; the biases of systems are carried from epoch to epoch
constexpr int kLeastFreedom = 4;  // fewer residuals do not count
constexpr double kClipScales = 4;
constexpr double kLongestIntervalS = 5;  // a longer one is an outage
constexpr double kIntervalGain = 0.05;

/// Sum of normal products of one variance, were they all like their median: 0.455 is that of chi-square with
/// one degree of freedom.
double SumByMedian(std::vector<double> products) {
  constexpr double kMedian = 0.455;
  const auto middle = products.begin() + static_cast<std::ptrdiff_t>(products.size() / 2);
  std::nth_element(products.begin(), middle, products.end());
  return *middle / kMedian * static_cast<double>(products.size());
}

}  // namespace

/// A single wrong satellite counts no more than the largest of the others.
PseudorangeErrors::Epoch PseudorangeErrors::Whiten(const SinglePointSolution& solution) {
  Epoch epoch{solution.tag_ns, {}};
  const double bound = kClipScales * solution.scale;
  for (const SatelliteResidual& satellite : solution.satellites) {
    if (satellite.used) {
      epoch.residuals.push_back({satellite.satellite,
                                 std::clamp(satellite.residual_m / satellite.deviation_m, -bound, bound),
                                 1 / (satellite.deviation_m * satellite.deviation_m)});
    }
  }
  std::sort(epoch.residuals.begin(), epoch.residuals.end(),
            [](const Whitened& a, const Whitened& b) { return a.satellite < b.satellite; });
  return epoch;
}

void PseudorangeErrors::Mean::Forget(double keep) {
  sum *= keep;
  of_medians *= keep;
  freedom *= keep;
  information *= keep;
  squares *= keep * keep;
}

double PseudorangeErrors::Mean::Relative() const {
  return freedom > 0 ? std::min(sum, of_medians) / freedom : 0;
}

double PseudorangeErrors::Mean::Deviation() const {
  return freedom > 0 ? std::sqrt(squares) / freedom : INFINITY;
}

void PseudorangeErrors::Forget(double since_s) {
  if (since_s < kLongestIntervalS) {
    interval_s_ += (interval_s_ > 0 ? kIntervalGain : 1) * (since_s - interval_s_);
  }
  for (std::size_t m = 0; m < memories_.size(); ++m) {
    for (Mean& mean : memories_[m]) {
      mean.Forget(std::exp(-since_s / kMemoriesS[m]));
    }
  }
}

void PseudorangeErrors::Add(const SinglePointSolution& solution) {
  const TimeNs now_ns = solution.tag_ns;
  if (history_.empty()) {
    first_ns_ = now_ns;
  } else {
    Forget(SecondsBetween(history_.back().tag_ns, now_ns));
  }
  history_.push_back(Whiten(solution));
  for (std::size_t lag = 0; lag < kLagsS.size(); ++lag) {
    // The latest epoch at least this much earlier, if it is not much earlier.
    const TimeNs from_ns = now_ns - SecondsToNs(kLagsS[lag]);
    const auto after =
        std::upper_bound(history_.begin(), history_.end(), from_ns,
                         [](TimeNs tag_ns, const Epoch& epoch) { return tag_ns < epoch.tag_ns; });
    if (after != history_.begin() &&
        SecondsBetween(std::prev(after)->tag_ns, from_ns) < 0.5 * kLagsS[lag] + interval_s_) {
      AddProducts(*std::prev(after), history_.back(), lag);
    }
  }
  while (SecondsBetween(history_.front().tag_ns, now_ns) > 1.5 * kLagsS.back()) {
    history_.pop_front();
  }
}

void PseudorangeErrors::AddProducts(const Epoch& earlier, const Epoch& now, std::size_t lag) {
  std::vector<double> products;
  products.reserve(now.residuals.size());
  double information = 0;
  auto other = earlier.residuals.begin();
  for (const Whitened& whitened : now.residuals) {
    while (other != earlier.residuals.end() && other->satellite < whitened.satellite) {
      ++other;
    }
    if (other != earlier.residuals.end() && other->satellite == whitened.satellite) {
      products.push_back(whitened.residual * other->residual);
      information += std::sqrt(whitened.information * other->information);
    }
  }
  const auto count = static_cast<double>(products.size());
  const double freedom = count - kUnknowns;
  if (freedom < kLeastFreedom) {
    return;
  }
  const double sum = std::accumulate(products.begin(), products.end(), 0.0);
  const double of_median = SumByMedian(std::move(products));
  for (Memory& memory : memories_) {
    Mean& mean = memory[lag];
    mean.sum += sum;
    mean.of_medians += of_median;
    mean.freedom += freedom;
    mean.information += information * freedom / count;
    mean.squares += freedom;
  }
}

void PseudorangeErrors::Lasting::Add(double from_s, double from, double to_s, double to) {
  const double length_s = to_s - from_s;
  integral += 0.5 * length_s * (from + to);
  moment += length_s / 6 * (from * (2 * from_s + to_s) + to * (from_s + 2 * to_s));
}

PseudorangeErrors::Lasting PseudorangeErrors::Integrate(const Memory& memory) const {
  const double reach_s = SecondsBetween(first_ns_, history_.back().tag_ns);
  const bool settled = reach_s >= kSettlingS;
  Lasting lasting;
  double from_s = 0;
  double before = 0;
  for (std::size_t lag = 1; lag < kLagsS.size(); ++lag) {
    const Mean& mean = memory[lag];
    if (!(mean.freedom > 0)) {
      if (reach_s < 1.5 * kLagsS[lag]) {
        break;  // not reached yet
      }
      continue;  // the epochs are farther apart
    }
    const double deviation = memory[0].Relative() * mean.Deviation();
    const bool significant = mean.Relative() > kSignificance * deviation;
    const double value = mean.Relative() + (significant || settled ? 0 : kDoubt * deviation);
    if (!significant && (settled || value <= 0)) {
      lasting.Add(from_s, before, kLagsS[lag], 0);
      return lasting;
    }
    lasting.variance = from_s > 0 ? lasting.variance : value;
    lasting.Add(from_s, from_s > 0 ? before : value, kLagsS[lag], value);
    from_s = kLagsS[lag];
    before = value;
  }
  if (reach_s > from_s) {
    lasting.Add(from_s, before, reach_s, before);
  }
  return lasting;
}

PseudorangeNoise PseudorangeErrors::noise() const {
  PseudorangeNoise noise;
  if (!(interval_s_ > 0)) {
    return noise;
  }
  const double reach_s = SecondsBetween(first_ns_, history_.back().tag_ns);
  for (const Memory& memory : memories_) {
    const Lasting lasting = Integrate(memory);
    if (lasting.variance > 0) {
      const double variance = lasting.variance * memory[0].StatedVariance();
      const double per_epoch = 2 / (lasting.variance * interval_s_);
      const double unsettled = lasting.moment / reach_s;
      const double epochs = 1 + per_epoch * std::max(0.0, lasting.integral - unsettled);
      if (epochs * variance > noise.epochs * noise.lasting_variance) {
        noise.lasting_variance = variance;
        noise.epochs = epochs;
        noise.settled_epochs = std::clamp(1 + per_epoch * (lasting.integral - 2 * unsettled), 1.0, epochs);
      }
    }
    const double white = memory[0].Relative() - lasting.variance;
    const double chance = kSignificance * std::sqrt(2.0) * memory[0].Relative() * memory[0].Deviation();
    noise.scale = std::max(noise.scale, white > 1 + chance ? std::sqrt(white) : 1);
  }
  return noise;
}

}  // namespace alidade
