#include "eval/identify/innovation_likelihood.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "filter/square_root_covariance.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

NoiseSource NoiseOf(RowSource source) {
  switch (source) {
    case RowSource::kVision:
    case RowSource::kRest:
      return NoiseSource::kPixel;
    case RowSource::kGnss:
      return NoiseSource::kGnss;
    case RowSource::kMeasurement:
      break;
  }
  return NoiseSource::kMeasurement;
}

/// B with B B^T = a symmetric positive semi-definite matrix.
Matrix15d SquareRoot(const Matrix15d& matrix) {
  const Eigen::LDLT<Matrix15d> factor(matrix);
  const Matrix15d lower = Matrix15d(factor.matrixL()) * factor.vectorD().cwiseMax(0).cwiseSqrt().asDiagonal();
  return factor.transpositionsP().transpose() * lower;
}

/// A Kalman filter on a recorded system.
class Replay {
 public:
  Replay(const LinearSystem& system, const PerNoise& log_scales)
      : log_scales_(log_scales), covariance_(system.capacity, system.max_leading) {
    fits_.reserve(system.frames);
  }

  // One function a kind of step; false when a number is not finite.
  bool operator()(const LinearSystem::Restart& restart) {
    covariance_.Assign(restart.leading, restart.root);
    offset_.setZero(restart.root.rows());
    return true;
  }

  bool operator()(const LinearSystem::Propagation& propagation) {
    Matrix15d q = Matrix15d::Zero();
    for (std::size_t j = 0; j < kImuNoiseSources; ++j) {
      q += std::exp(2 * log_scales_[j]) * propagation.q[j];
    }
    covariance_.Propagate(propagation.phi, SquareRoot(q));
    const Vector15d core = propagation.phi * offset_.segment<15>(covariance_.leading());
    offset_.segment<15>(covariance_.leading()) = core;
    return true;
  }

  bool operator()(const LinearSystem::ClockPropagation& clock) {
    const int first = covariance_.leading() - 6;
    covariance_.PropagateLeading(first, clock.phi, clock.q);
    const Vector6d terms = clock.phi * offset_.segment<6>(first);
    offset_.segment<6>(first) = terms;
    return true;
  }

  bool operator()(const LinearSystem::Cloning& clone) {
    covariance_.CloneCore(clone.first, clone.size);
    const Index place = covariance_.leading() + SquareRootCovariance::kCore;
    const VectorXd copy = offset_.segment(covariance_.leading() + clone.first, clone.size);
    VectorXd longer(offset_.size() + clone.size);
    longer << offset_.head(place), copy, offset_.tail(offset_.size() - place);
    offset_ = std::move(longer);
    return true;
  }

  bool operator()(const LinearSystem::Removal& removal) {
    covariance_.Remove(removal.first, removal.size);
    VectorXd shorter(offset_.size() - removal.size);
    shorter << offset_.head(removal.first), offset_.tail(shorter.size() - removal.first);
    offset_ = std::move(shorter);
    return true;
  }

  bool operator()(const LinearSystem::Shear& shear) {
    covariance_.Shear(shear.column, shear.row);
    offset_ += shear.row.dot(offset_) * shear.column;
    return true;
  }

  bool operator()(const LinearSystem::Update& update) {
    double nis = 0, log_det = 0;
    if (!Correct(update, &nis, &log_det)) {
      return false;
    }
    offset_ += correction_ - update.correction;
    return Count(update, nis, log_det);
  }

  bool operator()(const LinearSystem::FrameEnd& end) {
    fit_.stamp_ns = end.stamp_ns;
    fits_.push_back(fit_);
    fit_ = {};
    return true;
  }

  /// Updates the covariance; correction_ is that of the offset.
  bool Correct(const LinearSystem::Update& update, double* nis, double* log_det) {
    const double weight = std::exp(-LogScale(update.source));
    rows_.setZero(update.rows.rows(), offset_.size());
    rows_.rightCols(update.rows.cols()) = weight * update.rows;
    innovation_ = weight * update.innovation;
    innovation_.noalias() -= rows_ * offset_;
    correction_.resize(offset_.size());
    return covariance_.Apply(covariance_.Prepare(rows_, innovation_), correction_, nis, log_det);
  }

  [[nodiscard]] const VectorXd& correction() const { return correction_; }
  [[nodiscard]] std::vector<FrameFit> TakeFits() { return std::move(fits_); }

 private:
  [[nodiscard]] double LogScale(RowSource source) const {
    return source == RowSource::kRest ? 0 : log_scales_[static_cast<std::size_t>(NoiseOf(source))];
  }

  bool Count(const LinearSystem::Update& update, double nis, double log_det) {
    if (update.source == RowSource::kRest) {
      return true;
    }
    const double log_scale = LogScale(update.source);
    const int rows = static_cast<int>(update.rows.rows()) + update.discarded_rows;
    nis += update.discarded * std::exp(-2 * log_scale);
    fit_.log_likelihood -= 0.5 * (nis + log_det) + rows * log_scale;
    fit_.nis[static_cast<std::size_t>(update.source)] += nis;
    fit_.dof[static_cast<std::size_t>(update.source)] += rows;
    return std::isfinite(fit_.log_likelihood);
  }

  PerNoise log_scales_;
  SquareRootCovariance covariance_;
  VectorXd offset_;
  FrameFit fit_;
  std::vector<FrameFit> fits_;
  MatrixXd rows_;
  VectorXd innovation_;
  VectorXd correction_;
};

Status NotFinite() {
  return Status::Diverged("the innovations of the recorded filter are not finite");
}

}  // namespace

Result<std::vector<FrameFit>> EvaluateInnovations(const LinearSystem& system, const PerNoise& log_scales) {
  Replay replay(system, log_scales);
  for (const LinearSystem::Step& step : system.steps) {
    if (!std::visit(replay, step)) {
      return NotFinite();
    }
  }
  return replay.TakeFits();
}

Status FillCorrections(LinearSystem* system) {
  Replay replay(*system, PerNoise{});
  for (LinearSystem::Step& step : system->steps) {
    if (auto* update = std::get_if<LinearSystem::Update>(&step)) {
      // The recorded filter corrected its state by the whole of it: the offset stays zero.
      double nis = 0, log_det = 0;
      if (!replay.Correct(*update, &nis, &log_det)) {
        return NotFinite();
      }
      update->correction = replay.correction();
    } else if (!std::visit(replay, step)) {
      return NotFinite();
    }
  }
  return Status::Ok();
}

}  // namespace alidade
