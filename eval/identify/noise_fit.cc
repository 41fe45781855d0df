#include "eval/identify/noise_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dense_solvers.h"
#include "core/robust.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector4d;
using Eigen::VectorXd;

constexpr double kQuantile95 = 3.841;  ///< of chi-square of one degree of freedom
constexpr double kQuantile99 = 6.635;

/// A set of noises, one bit each by NoisePowers::Index.
using Noises = unsigned;
constexpr Noises kAllNoises = (1u << NoisePowers::kCount) - 1;

constexpr bool Has(Noises noises, int noise) {
  return (noises >> noise & 1u) != 0;
}

/// A fit of one set of noises.
struct SetFit {
  Noises noises = 0;
  Vector4d powers = Vector4d::Zero();
  Vector4d variances = Vector4d::Zero();  ///< of the powers
  double chi_square = 0;
  double criterion = std::numeric_limits<double>::infinity();  ///< chi-square + log det of the covariance
};

class AllanFit {
 public:
  AllanFit(const std::vector<AllanPoint>& points, const AllanCovariance& covariance)
      : covariance_(covariance) {
    const auto count = static_cast<Index>(points.size());
    design_.resize(count, NoisePowers::kCount);
    measured_.resize(count);
    for (Index i = 0; i < count; ++i) {
      const AllanPoint& point = points[static_cast<std::size_t>(i)];
      design_.row(i) = NoisePowers::VariancePerUnit(point.tau_s).transpose();
      measured_[i] = point.variance;
    }
    start_ = StartingPowers();
  }

  /// The set with the least criterion, and whose powers are all positive.
  [[nodiscard]] SetFit Best() const {
    SetFit best;
    double least = std::numeric_limits<double>::infinity();
    for (Noises noises = 1; noises <= kAllNoises; ++noises) {
      const SetFit fit = Converge(noises);
      double cost = fit.criterion;
      for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
        cost += Has(noises, noise) ? kQuantile99 : 0;
      }
      if (cost < least) {
        least = cost;
        best = fit;
      }
    }
    return best;
  }

  /// The power of a noise beside those of `fit` at which the criterion has risen to kQuantile95 above the
  /// least.
  [[nodiscard]] double UpperBound(const SetFit& fit, int noise) const {
    // From where the noise would hardly show at its most telling point.
    double power = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < measured_.size(); ++i) {
      power = std::min(power, 1e-3 * measured_[i] / design_(i, noise));
    }
    double least = fit.criterion;
    double criterion = least;
    for (int step = 0; step < 200 && criterion < least + kQuantile95; ++step) {
      power *= 1.1;
      Vector4d powers = fit.powers;
      powers[noise] = power;
      criterion = CriterionAt(powers);
      least = std::min(least, criterion);
    }
    return power;
  }

  [[nodiscard]] std::vector<double> DegreesOfFreedom(const Vector4d& powers) const {
    const MatrixXd covariance = covariance_.At(NoisePowers{powers});
    const VectorXd model = design_ * powers;
    std::vector<double> dof;
    for (Index i = 0; i < model.size(); ++i) {
      dof.push_back(2 * model[i] * model[i] / covariance(i, i));
    }
    return dof;
  }

 private:
  /// Each noise as large as the point at which it would be largest allows.
  [[nodiscard]] Vector4d StartingPowers() const {
    Vector4d powers;
    for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
      powers[noise] = measured_.cwiseQuotient(design_.col(noise)).minCoeff();
    }
    return powers;
  }

  [[nodiscard]] MatrixXd CovarianceAt(const Vector4d& powers) const {
    MatrixXd covariance = covariance_.At(NoisePowers{powers});
    covariance.diagonal() += kModelError * kModelError * (design_ * powers).cwiseAbs2();
    return covariance;
  }

  [[nodiscard]] double CriterionAt(const Vector4d& powers) const {
    const Eigen::LLT<MatrixXd> root(CovarianceAt(powers));
    if (root.info() != Eigen::Success) {
      return std::numeric_limits<double>::infinity();
    }
    const VectorXd residual = measured_ - design_ * powers;
    return residual.dot(root.solve(residual)) + 2 * root.matrixLLT().diagonal().array().log().sum();
  }

  /// One step of generalised least squares over a set, with the covariance at `powers`; positive ones alone.
  [[nodiscard]] SetFit Solve(Noises noises, const Vector4d& powers) const {
    std::vector<Index> chosen;
    for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
      if (Has(noises, noise)) {
        chosen.push_back(noise);
      }
    }
    const Eigen::LLT<MatrixXd> root(CovarianceAt(powers));
    MatrixXd design = design_(Eigen::all, chosen);
    const VectorXd scale = root.matrixL().solve(design).colwise().norm();
    design = design * scale.cwiseInverse().asDiagonal();
    const MatrixXd weighted = root.solve(design);
    const auto size = static_cast<Index>(chosen.size());
    const MatrixXd inverse =
        SymmetricSolver(design.transpose() * weighted).Solve(MatrixXd::Identity(size, size));
    const VectorXd solution = inverse * (weighted.transpose() * measured_);
    SetFit fit;
    fit.noises = noises;
    for (Index i = 0; i < size; ++i) {
      const Index noise = chosen[static_cast<std::size_t>(i)];
      fit.powers[noise] = solution[i] / scale[i];
      fit.variances[noise] = inverse(i, i) / (scale[i] * scale[i]);
    }
    return fit;
  }

  /// Iterates until no point's variance changes by a thousandth. The criterion stays infinite when a power
  /// would be negative: another set has the fit without it.
  [[nodiscard]] SetFit Converge(Noises noises) const {
    constexpr int kMostRounds = 60;
    constexpr double kSettled = 1e-3;
    Vector4d powers = Vector4d::Zero();
    for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
      powers[noise] = Has(noises, noise) ? start_[noise] : 0;
    }
    SetFit fit;
    for (int round = 0; round < kMostRounds; ++round) {
      fit = Solve(noises, powers);
      // Half a step: the covariance follows the fit, and a whole one may swing.
      const Vector4d next = 0.5 * (powers + fit.powers.cwiseMax(0.1 * powers));
      const double change = (design_ * (next - powers)).cwiseQuotient(design_ * powers).cwiseAbs().maxCoeff();
      powers = next;
      if (!(change > kSettled)) {
        break;
      }
    }
    bool positive = fit.powers.allFinite();
    for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
      positive = positive && (!Has(noises, noise) || fit.powers[noise] > 0);
    }
    if (positive) {
      const VectorXd residual = measured_ - design_ * fit.powers;
      fit.chi_square = residual.dot(Eigen::LLT<MatrixXd>(CovarianceAt(fit.powers)).solve(residual));
      fit.criterion = CriterionAt(fit.powers);
    }
    return fit;
  }

  const AllanCovariance& covariance_;
  MatrixXd design_;
  VectorXd measured_;
  Vector4d start_;
};

NoiseCoefficient Visible(double power, double variance) {
  const auto [low, high] = VarianceInterval(2 * power * power / variance);
  return {std::sqrt(power), std::sqrt(power * low), std::sqrt(power * high), true};
}

}  // namespace

std::pair<double, double> VarianceInterval(double dof) {
  // Quantiles change little from one whole number to the next but for the fewest, which take the wider one.
  const int whole = static_cast<int>(std::clamp(std::floor(dof), 1.0, 1e6));
  return {whole / ChiSquareQuantile(whole, 0.975), whole / ChiSquareQuantile(whole, 0.025)};
}

NoiseFit FitNoise(const std::vector<AllanPoint>& points, const AllanCovariance& covariance) {
  const AllanFit fit(points, covariance);
  const SetFit best = fit.Best();
  NoiseFit result;
  result.powers.value = best.powers;
  result.dof = fit.DegreesOfFreedom(best.powers);
  result.chi_square = best.chi_square;
  result.chi_square_dof = static_cast<int>(points.size());
  for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
    result.chi_square_dof -= Has(best.noises, noise) ? 1 : 0;
  }
  const double widening = std::max(1.0, best.chi_square / std::max(1, result.chi_square_dof));
  for (int noise = 0; noise < NoisePowers::kCount; ++noise) {
    result.coefficients[static_cast<std::size_t>(noise)] =
        Has(best.noises, noise) ? Visible(best.powers[noise], best.variances[noise] * widening)
                                : NoiseCoefficient{0, 0, std::sqrt(fit.UpperBound(best, noise)), false};
  }
  return result;
}

}  // namespace alidade
