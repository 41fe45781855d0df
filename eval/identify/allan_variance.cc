#include "eval/identify/allan_variance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace alidade {
namespace {

/// The phase x less a straight line, which second differences annul: it keeps the sums small.
std::vector<double> PhaseOf(const std::vector<double>& rates, double period_s) {
  const double mean = std::accumulate(rates.begin(), rates.end(), 0.0) / static_cast<double>(rates.size());
  std::vector<double> phase(rates.size() + 1, 0);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    phase[k + 1] = phase[k] + period_s * (rates[k] - mean);
  }
  return phase;
}

/// Cross-covariances of the second differences over m_a and m_b, of each noise of unit power, and the pairs
/// of them that a record holds. Times in samples.
class DifferencePair {
 public:
  using Products = Eigen::Matrix4d;  ///< of the noises' cross-covariances, summed

  DifferencePair(const AllanPoint& a, const AllanPoint& b, std::size_t samples)
      : pairs_a_(static_cast<double>(samples + 1 - 2 * a.cluster)),
        pairs_b_(static_cast<double>(samples + 1 - 2 * b.cluster)),
        m_a_(static_cast<double>(a.cluster)),
        m_b_(static_cast<double>(b.cluster)) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        kinks_[3 * i + j] = {static_cast<double>(i) * m_a_ - static_cast<double>(j) * m_b_,
                             kWeights[i] * kWeights[j]};
      }
    }
  }

  /// sum_s n(s) c_p(s) c_q(s) over all whole s, for all noises p, q.
  [[nodiscard]] Products Sum() const {
    const std::vector<double> breaks = Breaks();
    Products sum = Products::Zero();
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      AddBetween(breaks[i], breaks[i + 1], &sum);
    }
    AddDeltas(breaks.front(), breaks.back(), &sum);
    return sum;
  }

 private:
  static constexpr std::array<double, 3> kWeights = {1, -2, 1};

  [[nodiscard]] double Pairs(double s) const {
    return std::max(0.0, std::min(pairs_a_, pairs_b_ - s) - std::max(0.0, -s));
  }

  /// c(s) of each noise; that of quantisation is zero but at the kinks, see AddDeltas.
  [[nodiscard]] Eigen::Vector4d Smooth(double s) const {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const auto& [place, weight] : kinks_) {
      const double t = std::abs(s - place);
      sum[NoisePowers::kWhite] -= weight * t / 2;
      sum[NoisePowers::kFlicker] += t > 0 ? weight * t * t * std::log(t) / (2 * std::numbers::pi) : 0;
      sum[NoisePowers::kWalk] += weight * t * t * t / 12;
    }
    return sum;
  }

  /// Kinks of c and n, and ever longer steps where the tails of c fall off; sorted.
  [[nodiscard]] std::vector<double> Breaks() const {
    std::vector<double> breaks = {0, pairs_b_ - pairs_a_};
    const double widest = std::max(m_a_, m_b_);
    for (const auto& [place, weight] : kinks_) {
      breaks.push_back(place);
    }
    for (int power = -1; power <= 4; ++power) {
      const double tail = std::ldexp(widest, power);
      breaks.push_back(std::floor(2 * m_a_ + tail));
      breaks.push_back(std::ceil(-2 * m_b_ - tail));
    }
    for (double& place : breaks) {
      place = std::clamp(place, -pairs_a_, pairs_b_);
    }
    std::sort(breaks.begin(), breaks.end());
    breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
    return breaks;
  }

  void Add(double s, double weight, Products* sum) const {
    const Eigen::Vector4d c = Smooth(s);
    *sum += weight * Pairs(s) * c * c.transpose();
  }

  /// The part of the sum between two whole numbers, either end counted by half.
  void AddBetween(double from, double to, Products* sum) const {
    constexpr double kShort = 24;
    if (to - from <= kShort) {
      Add(from, 0.5, sum);
      Add(to, 0.5, sum);
      const int steps = static_cast<int>(to - from);
      for (int step = 1; step < steps; ++step) {
        Add(from + step, 1, sum);
      }
      return;
    }
    // Gauss-Legendre, eight points: exact for white noise and walk, whose terms are polynomials.
    constexpr std::array<std::pair<double, double>, 4> kGauss = {{{0.1834346424956498, 0.3626837833783620},
                                                                  {0.5255324099163290, 0.3137066458778873},
                                                                  {0.7966664774136267, 0.2223810344533745},
                                                                  {0.9602898564975363, 0.1012285362903763}}};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    for (const auto& [node, weight] : kGauss) {
      Add(middle - half * node, half * weight, sum);
      Add(middle + half * node, half * weight, sum);
    }
  }

  /// What quantisation adds at the kinks.
  void AddDeltas(double from, double to, Products* sum) const {
    for (std::size_t i = 0; i < kinks_.size(); ++i) {
      const double place = kinks_[i].first;
      double delta = 0;
      bool first = place >= from && place <= to;
      for (std::size_t j = 0; j < kinks_.size(); ++j) {
        const bool same = kinks_[j].first == place;
        delta += same ? kinks_[j].second : 0;
        first = first && !(same && j < i);
      }
      if (first) {
        constexpr int kQ = NoisePowers::kQuantisation;
        const Eigen::Vector4d mixed = Pairs(place) * delta * Smooth(place);
        sum->row(kQ) += mixed.transpose();
        sum->col(kQ) += mixed;
        (*sum)(kQ, kQ) += Pairs(place) * delta * delta;
      }
    }
  }

  double pairs_a_, pairs_b_, m_a_, m_b_;
  std::array<std::pair<double, double>, 9> kinks_;  ///< place and weight
};

}  // namespace

std::vector<AllanPoint> OverlappingAllanVariance(const std::vector<double>& rates, double period_s) {
  const std::vector<double> phase = PhaseOf(rates, period_s);
  std::vector<AllanPoint> points;
  const double largest = static_cast<double>(rates.size()) / 4;
  for (int half = 0; std::exp2(0.5 * half) <= largest; ++half) {  // in steps of a half power of two
    const auto m = static_cast<std::size_t>(std::lround(std::exp2(0.5 * half)));
    if (!points.empty() && points.back().cluster == m) {
      continue;
    }
    double sum = 0;
    const std::size_t terms = phase.size() - 2 * m;
    for (std::size_t k = 0; k < terms; ++k) {
      const double second = phase[k + 2 * m] - 2 * phase[k + m] + phase[k];
      sum += second * second;
    }
    const double tau_s = static_cast<double>(m) * period_s;
    points.push_back({m, tau_s, sum / (2 * tau_s * tau_s * static_cast<double>(terms))});
  }
  return points;
}

Eigen::Vector4d NoisePowers::VariancePerUnit(double tau_s) {
  return {3 / (tau_s * tau_s), 1 / tau_s, 2 * std::numbers::ln2 / std::numbers::pi, tau_s / 3};
}

AllanCovariance::AllanCovariance(const std::vector<AllanPoint>& points, std::size_t samples) {
  const double period_s = points.front().tau_s / static_cast<double>(points.front().cluster);
  scale_ = {1 / (period_s * period_s), 1 / period_s, 1, period_s};
  const auto count = static_cast<Eigen::Index>(points.size());
  for (Eigen::MatrixXd& part : parts_) {
    part.resize(count, count);
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const AllanPoint& a = points[static_cast<std::size_t>(i)];
      const AllanPoint& b = points[static_cast<std::size_t>(j)];
      const double m_a = static_cast<double>(a.cluster), m_b = static_cast<double>(b.cluster);
      const double pairs =
          static_cast<double>(samples + 1 - 2 * a.cluster) * static_cast<double>(samples + 1 - 2 * b.cluster);
      const Eigen::Matrix4d sum = DifferencePair(a, b, samples).Sum() / (2 * m_a * m_a * m_b * m_b * pairs);
      std::size_t part = 0;
      for (Eigen::Index p = 0; p < NoisePowers::kCount; ++p) {
        for (Eigen::Index q = 0; q <= p; ++q, ++part) {
          parts_[part](i, j) = parts_[part](j, i) = p == q ? sum(p, q) : 2 * sum(p, q);
        }
      }
    }
  }
}

Eigen::MatrixXd AllanCovariance::At(const NoisePowers& powers) const {
  const Eigen::Vector4d scaled = powers.value.cwiseProduct(scale_);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(parts_[0].rows(), parts_[0].cols());
  std::size_t part = 0;
  for (Eigen::Index p = 0; p < NoisePowers::kCount; ++p) {
    for (Eigen::Index q = 0; q <= p; ++q, ++part) {
      covariance += scaled[p] * scaled[q] * parts_[part];
    }
  }
  return covariance;
}

}  // namespace alidade
