#include "eval/identify/motion_noise.h"

#include <algorithm>
#include <cmath>

#include "core/dense_solvers.h"
#include "core/format.h"
#include "eval/identify/identifying_filter.h"
#include "eval/identify/scale_fit.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMostChange = 100;  ///< of a noise, either way, from what was assumed
constexpr double kNormal95 = 1.96;

std::vector<NoiseSource> SourcesOf(const LinearSystem& system) {
  std::vector<NoiseSource> sources = {NoiseSource::kGyro, NoiseSource::kAccel, NoiseSource::kGyroWalk,
                                      NoiseSource::kAccelWalk};
  const std::array<std::pair<RowSource, NoiseSource>, 3> sensors = {
      {{RowSource::kVision, NoiseSource::kPixel},
       {RowSource::kGnss, NoiseSource::kGnss},
       {RowSource::kMeasurement, NoiseSource::kMeasurement}}};
  for (const auto& [rows, noise] : sensors) {
    if (system.rows[static_cast<std::size_t>(rows)] > 0) {
      sources.push_back(noise);
    }
  }
  return sources;
}

/// The rounds of IdentifyInMotion.
class MotionFit {
 public:
  MotionFit(const EstimatorConfig& config, const MeasurementLog& log, const MotionOptions& options)
      : given_(IdentifyingFilter(config)),
        config_(given_),
        log_(log),
        options_(options),
        assumed_(AssumedNoise(config, log)),
        noise_(assumed_) {}

  Result<MotionNoise> Execute() {
    for (result_.rounds = 1; result_.rounds <= options_.most_rounds && !result_.converged; ++result_.rounds) {
      ALIDADE_RETURN_IF_ERROR(Round());
    }
    --result_.rounds;
    ALIDADE_RETURN_IF_ERROR(Conclude());
    return std::move(result_);
  }

 private:
  /// Records the filter at noise_ and prepares a fit of the factors on it.
  Status Record() {
    AssumeNoise(noise_, given_, &config_, &log_);
    Result<LinearSystem> system = RecordFilter(config_, log_, options_.run);
    ALIDADE_RETURN_IF_ERROR(system.status());
    system_ = *std::move(system);
    constexpr std::size_t kLeastFrames = 20;
    if (system_.frames < kLeastFrames) {
      return Status::Input(
          Format("%zu frames were filtered, expected at least %zu", system_.frames, kLeastFrames));
    }
    PerNoise low{}, high{};
    for (std::size_t i = 0; i < kNoiseSources; ++i) {
      low[i] = std::log(assumed_[i] / kMostChange / noise_[i]);
      high[i] = std::log(assumed_[i] * kMostChange / noise_[i]);
    }
    fit_.emplace(system_, SourcesOf(system_), low, high, options_.jobs);
    return Status::Ok();
  }

  Status Round() {
    constexpr double kSettled = 0.01;
    constexpr int kSteps = 3;
    ALIDADE_RETURN_IF_ERROR(Record());
    ALIDADE_RETURN_IF_ERROR(fit_->Maximize(kSteps, kSettled));
    double most = 0;
    for (std::size_t i = 0; i < kNoiseSources; ++i) {
      const double change = fit_->log_scales()[i];
      noise_[i] *= std::exp(change);
      // A walk that the recording does not show may drift for ever without changing anything.
      const bool counts = i != IndexOf(NoiseSource::kGyroWalk) && i != IndexOf(NoiseSource::kAccelWalk);
      most = counts ? std::max(most, std::abs(change)) : most;
    }
    result_.runs += fit_->runs();
    result_.converged = most < kSettled;
    ReportRound(result_.rounds);
    return Status::Ok();
  }

  void ReportRound(int round) const {
    if (!options_.progress) {
      return;
    }
    std::string line = Format("round %d:", round);
    for (const NoiseSource source : fit_->sources()) {
      line += Format("  %s %.3g", NameOf(source), noise_[IndexOf(source)]);
    }
    options_.progress(line);
  }

  /// Intervals and the check by halves, at the last noises.
  Status Conclude() {
    ALIDADE_RETURN_IF_ERROR(Record());
    ALIDADE_RETURN_IF_ERROR(fit_->Maximize(1, 1e-3));
    for (std::size_t i = 0; i < kNoiseSources; ++i) {
      noise_[i] *= std::exp(fit_->log_scales()[i]);
    }
    ALIDADE_RETURN_IF_ERROR(FindIntervals());
    Result<std::vector<FrameFit>> frames = EvaluateInnovations(system_, fit_->log_scales());
    ALIDADE_RETURN_IF_ERROR(frames.status());
    result_.frames = *std::move(frames);
    ALIDADE_RETURN_IF_ERROR(CheckHalves());
    result_.runs += fit_->runs();
    result_.sheet = ImuNoiseOf(noise_);
    result_.pixel_noise_px = noise_[IndexOf(NoiseSource::kPixel)];
    if (!result_.converged) {
      result_.remarks.push_back(
          Format("the noises still changed by more than 1 %% after %d rounds", result_.rounds));
    }
    return Status::Ok();
  }

  Status FindIntervals() {
    const Result<MatrixXd> information = fit_->ObservedInformation();
    ALIDADE_RETURN_IF_ERROR(information.status());
    // A parabola over less than this standard deviation of the logarithm is taken for the likelihood's shape.
    constexpr double kParabola = 0.35;
    const std::vector<NoiseSource>& sources = fit_->sources();
    strong_.clear();
    std::vector<Index> kept;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const auto k = static_cast<Index>(i);
      strong_.push_back((*information)(k, k) > 1 / (kParabola * kParabola));
      if (strong_.back()) {
        kept.push_back(k);
      }
    }
    const auto size = static_cast<Index>(kept.size());
    MatrixXd part(size, size);
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        part(i, j) = (*information)(kept[static_cast<std::size_t>(i)], kept[static_cast<std::size_t>(j)]);
      }
    }
    const MatrixXd covariance = SymmetricSolver(part).Solve(MatrixXd::Identity(size, size));
    Index next = 0;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const double variance = strong_[i] ? covariance(next, next) : 0;
      next += strong_[i] ? 1 : 0;
      ALIDADE_RETURN_IF_ERROR(AddNoise(sources[i], variance));
    }
    return Status::Ok();
  }

  /// `log_variance`: of the logarithm; not positive where no parabola describes the likelihood.
  Status AddNoise(NoiseSource source, double log_variance) {
    IdentifiedNoise noise{source, assumed_[IndexOf(source)], noise_[IndexOf(source)]};
    noise.weak = !(log_variance > 0);
    if (!noise.weak) {
      const double factor = std::exp(kNormal95 * std::sqrt(log_variance));
      noise.low = noise.value / factor;
      noise.high = noise.value * factor;
    } else {
      const Result<double> below = fit_->LikelihoodBound(source, -1);
      ALIDADE_RETURN_IF_ERROR(below.status());
      const Result<double> above = fit_->LikelihoodBound(source, 1);
      ALIDADE_RETURN_IF_ERROR(above.status());
      const double reference = noise.value / std::exp(fit_->log_scales()[IndexOf(source)]);
      noise.low = reference * std::exp(*below);
      noise.high = reference * std::exp(*above);
      // At the end of what was tried there is no bound.
      noise.low = noise.low < 1.001 * noise.assumed / kMostChange ? 0 : noise.low;
      noise.high = noise.high > noise.assumed * kMostChange / 1.001 ? std::numeric_limits<double>::infinity()
                                                                    : noise.high;
      result_.remarks.push_back(
          std::string(NameOf(source)) +
          ": weakly observable in this recording; its interval is what counts, not its value");
    }
    result_.noises.push_back(noise);
    return Status::Ok();
  }

  Status CheckHalves() {
    const std::size_t frames = result_.frames.size(), middle = frames / 2;
    for (const bool first : {true, false}) {
      // The half to be predicted, and the noises by one Newton step on the scores of the other.
      const std::size_t begin = first ? 0 : middle, end = first ? middle : frames;
      const VectorXd step =
          first ? fit_->StepOfFrames(middle, frames, strong_) : fit_->StepOfFrames(0, middle, strong_);
      PerNoise scales = fit_->log_scales();
      for (std::size_t i = 0; i < fit_->sources().size(); ++i) {
        scales[IndexOf(fit_->sources()[i])] += step[static_cast<Index>(i)];
      }
      const Result<std::vector<FrameFit>> fits = EvaluateInnovations(system_, scales);
      ALIDADE_RETURN_IF_ERROR(fits.status());
      HalfFit& half = result_.halves[first ? 0 : 1];
      half.name = first ? "first" : "second";
      for (std::size_t k = begin; k < end; ++k) {
        for (std::size_t source = 0; source < half.dof.size(); ++source) {
          half.nis_ratio[source] += (*fits)[k].nis[source];
          half.dof[source] += (*fits)[k].dof[source];
        }
      }
      for (std::size_t source = 0; source < half.dof.size(); ++source) {
        half.nis_ratio[source] /= std::max(1, half.dof[source]);
      }
    }
    return Status::Ok();
  }

  const EstimatorConfig given_;
  EstimatorConfig config_;
  MeasurementLog log_;
  const MotionOptions& options_;
  const PerNoise assumed_;
  PerNoise noise_;
  LinearSystem system_;
  std::optional<ScaleFit> fit_;
  std::vector<bool> strong_;  ///< by sources(): a parabola describes the likelihood
  MotionNoise result_;
};

}  // namespace

Result<MotionNoise> IdentifyInMotion(const EstimatorConfig& config, const MeasurementLog& log,
                                     const MotionOptions& options) {
  return MotionFit(config, log, options).Execute();
}

}  // namespace alidade
