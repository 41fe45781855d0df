#include "gnss/positioning/pseudorange_errors.h"

#include <algorithm>
#include <cmath>
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
  weight *= keep;
  squares *= keep * keep;
}

void PseudorangeErrors::Mean::Add(double products, double by_median, double freedom, double new_weight) {
  sum += products;
  of_medians += by_median;
  weight += new_weight;
  squares += freedom;
}

double PseudorangeErrors::Mean::Deviation() const {
  return weight > 0 ? std::sqrt(squares) / weight : INFINITY;
}

void PseudorangeErrors::Forget(double since_s) {
  if (since_s < kLongestIntervalS) {
    interval_s_ += (interval_s_ > 0 ? kIntervalGain : 1) * (since_s - interval_s_);
  }
  for (std::size_t m = 0; m < memories_.size(); ++m) {
    const double keep = std::exp(-since_s / kMemoriesS[m]);
    memories_[m].variance.Forget(keep);
    memories_[m].information.Forget(keep);
    for (Mean& mean : memories_[m].lagged) {
      mean.Forget(keep);
    }
  }
}

void PseudorangeErrors::AddSquares(const Epoch& now) {
  const auto count = static_cast<double>(now.residuals.size());
  const double freedom = count - kUnknowns;
  if (freedom < kLeastFreedom) {
    return;
  }
  std::vector<double> each;
  double squares = 0;
  double information = 0;
  for (const Whitened& whitened : now.residuals) {
    each.push_back(whitened.residual * whitened.residual);
    squares += each.back();
    information += whitened.information;
  }
  const double by_median = SumByMedian(std::move(each));
  for (Memory& memory : memories_) {
    memory.variance.Add(squares, by_median, freedom, freedom);
    memory.information.Add(information, information, freedom, count);
  }
}

void PseudorangeErrors::Add(const SinglePointSolution& solution) {
  Epoch now = Whiten(solution);
  if (history_.empty()) {
    first_ns_ = now.tag_ns;
  } else {
    Forget(SecondsBetween(history_.back().tag_ns, now.tag_ns));
  }
  AddSquares(now);
  for (std::size_t lag = 0; lag < kLagsS.size(); ++lag) {
    // The latest epoch at least this much earlier, if it is not much earlier.
    const TimeNs from_ns = now.tag_ns - SecondsToNs(kLagsS[lag]);
    const auto after =
        std::upper_bound(history_.begin(), history_.end(), from_ns,
                         [](TimeNs tag_ns, const Epoch& epoch) { return tag_ns < epoch.tag_ns; });
    if (after != history_.begin() &&
        SecondsBetween(std::prev(after)->tag_ns, from_ns) < 0.5 * kLagsS[lag] + interval_s_) {
      AddProducts(*std::prev(after), now, lag);
    }
  }
  history_.push_back(std::move(now));
  while (SecondsBetween(history_.front().tag_ns, history_.back().tag_ns) > 1.5 * kLagsS.back()) {
    history_.pop_front();
  }
}

void PseudorangeErrors::AddProducts(const Epoch& earlier, const Epoch& now, std::size_t lag) {
  std::vector<double> each;
  double products = 0;
  double information = 0;
  int common = 0;
  auto other = earlier.residuals.begin();
  for (const Whitened& whitened : now.residuals) {
    while (other != earlier.residuals.end() && other->satellite < whitened.satellite) {
      ++other;
    }
    if (other != earlier.residuals.end() && other->satellite == whitened.satellite) {
      each.push_back(whitened.residual * other->residual);
      products += each.back();
      information += std::sqrt(whitened.information * other->information);
      ++common;
    }
  }
  const double freedom = common - kUnknowns;
  if (freedom >= kLeastFreedom) {
    const double by_median = SumByMedian(std::move(each));
    for (Memory& memory : memories_) {
      memory.lagged[lag].Add(products, by_median, freedom, information * freedom / common);
    }
  }
}

void PseudorangeErrors::Lasting::Add(double from_s, double from_m2, double to_s, double to_m2) {
  const double length_s = to_s - from_s;
  integral += 0.5 * length_s * (from_m2 + to_m2);
  moment += length_s / 6 * (from_m2 * (2 * from_s + to_s) + to_m2 * (from_s + 2 * to_s));
}

PseudorangeErrors::Lasting PseudorangeErrors::Integrate(const Memory& memory) const {
  const double reach_s = SecondsBetween(first_ns_, history_.back().tag_ns);
  const double variance = memory.variance.value();
  Lasting lasting;
  double from_s = 0;
  double before = 0;
  for (std::size_t lag = 0; lag < kLagsS.size(); ++lag) {
    const Mean& mean = memory.lagged[lag];
    if (!(mean.weight > 0)) {
      if (reach_s < 1.5 * kLagsS[lag]) {
        break;  // not reached yet
      }
      continue;  // the epochs are farther apart
    }
    const double deviation = variance * mean.Deviation();
    const bool significant = mean.value() > kSignificance * deviation;
    const double value = mean.value() + (significant || reach_s >= kSettlingS ? 0 : kDoubt * deviation);
    if (!significant && (reach_s >= kSettlingS || value <= 0)) {
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
      const double per_epoch = 2 / (lasting.variance * interval_s_);
      const double unsettled = lasting.moment / reach_s;
      const double epochs = 1 + per_epoch * std::max(0.0, lasting.integral - unsettled);
      if (epochs * lasting.variance > noise.epochs * noise.lasting_variance) {
        noise.lasting_variance = lasting.variance;
        noise.epochs = epochs;
        noise.settled_epochs = std::clamp(1 + per_epoch * (lasting.integral - 2 * unsettled), 1.0, epochs);
      }
    }
    const double white = memory.variance.value() - lasting.variance * memory.information.value();
    const double chance =
        kSignificance * std::sqrt(2.0) * memory.variance.value() * memory.variance.Deviation();
    noise.scale = std::max(noise.scale, white > 1 + chance ? std::sqrt(white) : 1);
  }
  return noise;
}

}  // namespace alidade
