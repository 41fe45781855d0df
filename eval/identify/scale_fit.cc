#include "eval/identify/scale_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/blas.h"
#include "core/dense_solvers.h"
#include "eval/files/parallel_for.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Fits = std::vector<FrameFit>;

double TotalOf(const Fits& fits) {
  double total = 0;
  for (const FrameFit& fit : fits) {
    total += fit.log_likelihood;
  }
  return total;
}

VectorXd Unit(Index size, Index index, double length) {
  VectorXd vector = VectorXd::Zero(size);
  vector[index] = length;
  return vector;
}

/// Information of the frames' scores about their mean.
MatrixXd ScatterOf(const MatrixXd& scores) {
  const MatrixXd centred = scores.rowwise() - scores.colwise().mean();
  return centred.transpose() * centred;
}

/// information^-1 gradient over the components that are `free`.
VectorXd NewtonStep(MatrixXd information, VectorXd gradient, const std::vector<bool>& free) {
  constexpr double kLongest = 1.5;
  for (Index i = 0; i < gradient.size(); ++i) {
    if (!free[static_cast<std::size_t>(i)]) {
      information.row(i).setZero();
      information.col(i).setZero();
      gradient[i] = 0;
    }
    // As if by a vague prior: a flat direction must not make a step infinite.
    information(i, i) += 1;
  }
  return SymmetricSolver(information).Solve(gradient).col(0).cwiseMax(-kLongest).cwiseMin(kLongest);
}

}  // namespace

ScaleFit::ScaleFit(const LinearSystem& system, std::vector<NoiseSource> sources, const PerNoise& low,
                   const PerNoise& high, int jobs)
    : system_(system),
      sources_(std::move(sources)),
      low_(low),
      high_(high),
      jobs_(BlasIsThreadSafe() ? jobs : 1) {}

PerNoise ScaleFit::Changed(const VectorXd& change) const {
  PerNoise scales = log_scales_;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    scales[static_cast<std::size_t>(sources_[i])] += change[static_cast<Index>(i)];
  }
  return scales;
}

Result<std::vector<Fits>> ScaleFit::EvaluateAll(const std::vector<VectorXd>& changes) {
  std::vector<Fits> fits(changes.size());
  const auto evaluate = [&](std::size_t i) {
    Result<Fits> evaluated = EvaluateInnovations(system_, Changed(changes[i]));
    if (evaluated.ok()) {
      fits[i] = std::move(*evaluated);
    }
    return evaluated.status();
  };
  ALIDADE_RETURN_IF_ERROR(ParallelFor(changes.size(), jobs_, evaluate));
  runs_ += static_cast<int>(changes.size());
  return fits;
}

Result<double> ScaleFit::TotalAt(const VectorXd& change) {
  const Result<std::vector<Fits>> fits = EvaluateAll({change});
  ALIDADE_RETURN_IF_ERROR(fits.status());
  return TotalOf(fits->front());
}

Status ScaleFit::Differentiate() {
  const auto size = static_cast<Index>(sources_.size());
  std::vector<VectorXd> changes = {VectorXd::Zero(size)};
  for (Index i = 0; i < size; ++i) {
    changes.push_back(Unit(size, i, kLogStep));
    changes.push_back(Unit(size, i, -kLogStep));
  }
  const Result<std::vector<Fits>> fits = EvaluateAll(changes);
  ALIDADE_RETURN_IF_ERROR(fits.status());
  total_ = TotalOf((*fits)[0]);
  plus_.resize(size);
  minus_.resize(size);
  scores_.resize(static_cast<Index>((*fits)[0].size()), size);
  for (Index i = 0; i < size; ++i) {
    const Fits& plus = (*fits)[static_cast<std::size_t>(2 * i + 1)];
    const Fits& minus = (*fits)[static_cast<std::size_t>(2 * i + 2)];
    plus_[i] = TotalOf(plus);
    minus_[i] = TotalOf(minus);
    for (Index k = 0; k < scores_.rows(); ++k) {
      const auto frame = static_cast<std::size_t>(k);
      scores_(k, i) = (plus[frame].log_likelihood - minus[frame].log_likelihood) / (2 * kLogStep);
    }
  }
  return Status::Ok();
}

Status ScaleFit::Maximize(int steps, double tolerance) {
  constexpr int kMostHalvings = 5;
  ALIDADE_RETURN_IF_ERROR(Differentiate());
  for (int step = 0; step < steps; ++step) {
    VectorXd change =
        NewtonStep(StepInformation(), scores_.colwise().sum(), std::vector<bool>(sources_.size(), true));
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const auto source = static_cast<std::size_t>(sources_[i]);
      double& part = change[static_cast<Index>(i)];
      part = std::clamp(part, low_[source] - log_scales_[source], high_[source] - log_scales_[source]);
    }
    if (change.cwiseAbs().maxCoeff() < tolerance) {
      break;
    }
    Result<double> total = TotalAt(change);
    for (int halving = 0; halving < kMostHalvings && total.ok() && *total < total_; ++halving) {
      change *= 0.5;
      total = TotalAt(change);
    }
    ALIDADE_RETURN_IF_ERROR(total.status());
    if (*total < total_) {
      break;
    }
    log_scales_ = Changed(change);
    ALIDADE_RETURN_IF_ERROR(Differentiate());
  }
  return Status::Ok();
}

Result<MatrixXd> ScaleFit::ObservedInformation() {
  const auto size = static_cast<Index>(sources_.size());
  std::vector<VectorXd> changes;
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < i; ++j) {
      changes.push_back(Unit(size, i, kLogStep) + Unit(size, j, kLogStep));
      changes.push_back(Unit(size, i, -kLogStep) + Unit(size, j, -kLogStep));
    }
  }
  const Result<std::vector<Fits>> fits = EvaluateAll(changes);
  ALIDADE_RETURN_IF_ERROR(fits.status());
  MatrixXd information(size, size);
  std::size_t next = 0;
  for (Index i = 0; i < size; ++i) {
    information(i, i) = (2 * total_ - plus_[i] - minus_[i]) / (kLogStep * kLogStep);
    for (Index j = 0; j < i; ++j, next += 2) {
      const double both = TotalOf((*fits)[next]) + TotalOf((*fits)[next + 1]);
      information(i, j) = information(j, i) =
          (plus_[i] + plus_[j] + minus_[i] + minus_[j] - 2 * total_ - both) / (2 * kLogStep * kLogStep);
    }
  }
  return information;
}

Result<double> ScaleFit::LikelihoodBound(NoiseSource source, double side) {
  constexpr double kFirst = 0.25, kDrop = 3.841;
  const auto of_noise = static_cast<std::size_t>(source);
  const auto size = static_cast<Index>(sources_.size());
  const Index index = std::find(sources_.begin(), sources_.end(), source) - sources_.begin();
  const double most =
      side > 0 ? high_[of_noise] - log_scales_[of_noise] : log_scales_[of_noise] - low_[of_noise];
  double before = 0, root_before = 0;
  for (double length = kFirst; before < most; length *= 1.5) {
    const double tried = std::min(length, most);
    const Result<double> total = TotalAt(Unit(size, index, side * tried));
    ALIDADE_RETURN_IF_ERROR(total.status());
    // Twice the drop grows about as the square of the distance.
    const double root = std::sqrt(std::max(0.0, 2 * (total_ - *total)));
    const double wanted = std::sqrt(kDrop);
    if (root >= wanted) {
      return log_scales_[of_noise] +
             side * (before + (tried - before) * (wanted - root_before) / (root - root_before));
    }
    before = tried;
    root_before = root;
  }
  return log_scales_[of_noise] + side * most;
}

MatrixXd ScaleFit::StepInformation() const {
  const MatrixXd scatter = ScatterOf(scores_);
  VectorXd scale(scatter.rows());
  for (Index i = 0; i < scale.size(); ++i) {
    const double curvature = (2 * total_ - plus_[i] - minus_[i]) / (kLogStep * kLogStep);
    scale[i] = scatter(i, i) > 0 && curvature > 0 ? std::sqrt(curvature / scatter(i, i)) : 1;
  }
  return scale.asDiagonal() * scatter * scale.asDiagonal();
}

VectorXd ScaleFit::StepOfFrames(std::size_t first, std::size_t end, const std::vector<bool>& free) const {
  const MatrixXd scores = scores_.middleRows(static_cast<Index>(first), static_cast<Index>(end - first));
  return NewtonStep(ScatterOf(scores), scores.colwise().sum(), free);
}

}  // namespace alidade
