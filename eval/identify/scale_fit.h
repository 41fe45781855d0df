#pragma once

#include <Eigen/Core>
#include <vector>

#include "eval/identify/innovation_likelihood.h"

namespace alidade {

/// Maximises the innovation likelihood of one recorded system over the logarithms of some noises' factors.
///
/// Scores come from central differences with kLogStep, frame by frame. The innovations of different frames
/// are independent, so the scatter of the frames' scores is the information at the maximum (Berndt et al.
/// 1974), but not far from it. A Newton step takes from it the correlations alone, and the diagonal from the
/// second differences. A step that does not raise the likelihood is halved.
class ScaleFit {
 public:
  static constexpr double kLogStep = 0.1;

  /// `sources`: the noises to fit; the others stay as recorded. `bounds`: of the log factors. `jobs`: threads
  /// for the runs of one derivative. The system must outlive the fit.
  ScaleFit(const LinearSystem& system, std::vector<NoiseSource> sources, const PerNoise& low,
           const PerNoise& high, int jobs);

  /// At most `steps` Newton steps, fewer when one changes every factor by less than `tolerance` (log).
  /// kDiverged: EvaluateInnovations'.
  Status Maximize(int steps, double tolerance);

  /// Minus the second derivatives of the log-likelihood at the present factors, in the order of sources();
  /// central differences. Errors as above.
  Result<Eigen::MatrixXd> ObservedInformation();
  /// The log factor of one noise at which twice the log-likelihood is 3.84 (95 % of chi-square of one degree
  /// of freedom) below that of the present factors, the others held; the bound when it is nowhere so on that
  /// side. `side`: -1 or 1.
  Result<double> LikelihoodBound(NoiseSource source, double side);
  /// The Newton step of the frames [first, end) alone from the present factors on, over `free` of sources();
  /// after Maximize.
  [[nodiscard]] Eigen::VectorXd StepOfFrames(std::size_t first, std::size_t end,
                                             const std::vector<bool>& free) const;

  [[nodiscard]] const std::vector<NoiseSource>& sources() const { return sources_; }
  [[nodiscard]] const PerNoise& log_scales() const { return log_scales_; }
  [[nodiscard]] int runs() const { return runs_; }

 private:
  /// Log-likelihoods at the present factors changed by each of `changes`.
  Result<std::vector<std::vector<FrameFit>>> EvaluateAll(const std::vector<Eigen::VectorXd>& changes);
  Result<double> TotalAt(const Eigen::VectorXd& change);
  [[nodiscard]] PerNoise Changed(const Eigen::VectorXd& change) const;
  Status Differentiate();
  [[nodiscard]] Eigen::MatrixXd StepInformation() const;

  const LinearSystem& system_;
  std::vector<NoiseSource> sources_;
  PerNoise low_, high_;
  int jobs_;
  PerNoise log_scales_{};
  int runs_ = 0;
  double total_ = 0;              ///< at log_scales_
  Eigen::MatrixXd scores_;        ///< frames x sources, there
  Eigen::VectorXd plus_, minus_;  ///< totals one kLogStep to either side
};

}  // namespace alidade
