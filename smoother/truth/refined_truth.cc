#include "smoother/truth/refined_truth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/imu_propagation.h"
#include "core/imu_step.h"
#include "smoother/truth/fixed_point.h"
#include "smoother/truth/truth_terms.h"

namespace alidade {
namespace {

constexpr size_t kMinPoses = 10;
// Samples kept before the first and after the last pose: the time offset moves the poses.
constexpr double kMarginSeconds = 0.1;
constexpr int kRobustIterations = 4;
constexpr int kGateIterations = 15;  // of the poses; afterwards they are held
constexpr int kMaxIterations = 40;
constexpr double kSettledSigma = 0.01;
constexpr double kSettledNoise = 1e-4;  // relative
constexpr double kImuGapSteps = 10;
constexpr double kScaleSigma = 0.02;  // of an inertial sensor's sheet
constexpr double kHeldSigma = 1e-8;   // of what is not estimated
constexpr int kOrientationRow = 0;
constexpr int kPositionRow = 3;

class Refinement {
 public:
  Refinement(std::span<const ImuSample> imu, std::span<const TruthPose> poses,
             const TruthRefinementOptions& options)
      : options_(options),
        imu_model_{options.imu_noise, GravityInWorld(options.gravity_mps2)},
        imu_(imu),
        poses_(poses, options.gate_probability, options.noise) {}

  Result<RefinedTruth> Execute() {
    ALIDADE_RETURN_IF_ERROR(Begin());
    ArrowSystem system(states_.size());
    for (result_.iterations = 1; result_.iterations <= kMaxIterations; ++result_.iterations) {
      if (options_.stop != nullptr && options_.stop->load()) {
        return Status::Diverged("refine_truth: interrupted");
      }
      const TruthNoise before = poses_.noise();
      const bool robust = result_.iterations <= kRobustIterations;
      ALIDADE_RETURN_IF_ERROR(Linearize(robust, &system));
      Step(system);
      poses_.Attach(imu_, constants_.time_offset_s);
      UpdateWeights(robust);
      if (!robust && IsSettled(system, before)) {
        return Finish(&system);
      }
    }
    return Status::Diverged(
        Format("refine_truth: %g standard deviations from the minimum after %d iterations; "
               "expected at most %g",
               std::sqrt(system.newton_decrement()), kMaxIterations, kSettledSigma));
  }

 private:
  Status Begin() {
    const ImuNoise& noise = options_.imu_noise;
    if (!(noise.gyro_noise_density_radps_sqrthz > 0 && noise.accel_noise_density_mps2_sqrthz > 0 &&
          noise.gyro_random_walk_radps2_sqrthz > 0 && noise.accel_random_walk_mps3_sqrthz > 0)) {
      return Status::Input("refine_truth: a noise density of the IMU is zero, expected four positive ones");
    }
    std::vector<TruthPose> poses;
    if (imu_.size() >= 2) {
      for (const GatedPose& pose : poses_.poses()) {
        if (pose.pose.stamp_ns >= imu_.front().stamp_ns && pose.pose.stamp_ns < imu_.back().stamp_ns) {
          poses.push_back(pose.pose);
        }
      }
    }
    if (poses.size() < kMinPoses) {
      return Status::Input(
          Format("refine_truth: %zu poses of the truth lie within the IMU's time, expected at least %zu",
                 poses.size(), kMinPoses));
    }
    TruthStart start = StartTruth(imu_, poses);
    constants_ = first_constants_ = start.constants;
    CutSamples(&start.states);
    ApplyScale();
    CountImuGaps();
    poses_.Attach(imu_, constants_.time_offset_s);
    return Status::Ok();
  }

  /// To those that the poses reach.
  void CutSamples(std::vector<TruthState>* states) {
    const TimeNs offset_ns = SecondsToNs(constants_.time_offset_s);
    const TimeNs first_ns = poses_.poses().front().pose.stamp_ns + offset_ns - SecondsToNs(kMarginSeconds);
    const TimeNs last_ns = poses_.poses().back().pose.stamp_ns + offset_ns + SecondsToNs(kMarginSeconds);
    size_t begin = 0;
    while (begin + 2 < imu_.size() && imu_[begin + 1].stamp_ns <= first_ns) {
      ++begin;
    }
    size_t end = imu_.size();
    while (end > begin + 2 && imu_[end - 2].stamp_ns >= last_ns) {
      --end;
    }
    imu_ = imu_.subspan(begin, end - begin);
    states_.assign(states->begin() + static_cast<std::ptrdiff_t>(begin),
                   states->begin() + static_cast<std::ptrdiff_t>(end));
  }

  void CountImuGaps() {
    std::vector<TimeNs> steps;
    for (size_t i = 1; i < imu_.size(); ++i) {
      steps.push_back(imu_[i].stamp_ns - imu_[i - 1].stamp_ns);
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    const double limit = kImuGapSteps * static_cast<double>(*middle);
    result_.imu_gaps = static_cast<int>(std::count_if(
        steps.begin(), steps.end(), [&](TimeNs step) { return static_cast<double>(step) > limit; }));
  }

  [[nodiscard]] TruthPoseTerm Term(const GatedPose& pose) const {
    const size_t i = *pose.state;
    return LinearizePose(pose.pose.T_TM, pose.pose.stamp_ns + SecondsToNs(constants_.time_offset_s),
                         scaled_[i], scaled_[i + 1], states_[i], constants_, imu_model_);
  }

  /// Divides the rows by the deviations of the noise.
  void Whiten(double weight, TruthPoseTerm* term) const {
    Vector6d scale;
    scale << Eigen::Vector3d::Constant(std::sqrt(weight) / poses_.noise().orientation_rad),
        Eigen::Vector3d::Constant(std::sqrt(weight) / poses_.noise().position_m);
    term->residual = scale.cwiseProduct(term->residual);
    term->of_state = (scale.asDiagonal() * term->of_state).eval();
    term->of_constants = (scale.asDiagonal() * term->of_constants).eval();
  }

  Status Linearize(bool robust, ArrowSystem* system) {
    system->Reset();
    AddPriors(system);
    for (size_t k = 0; k + 1 < states_.size(); ++k) {
      const std::optional<TruthLink> link =
          LinearizeLink(scaled_[k], scaled_[k + 1], states_[k], states_[k + 1], imu_model_);
      if (!link) {
        return Status::Input("refine_truth: the IMU sample at " + FormatSeconds(imu_[k].stamp_ns) +
                             " s is not finite or its noise is singular");
      }
      system->AddLink(k, link->residual, link->of_first, link->of_second, link->of_constants);
    }
    for (const GatedPose& pose : poses_.poses()) {
      if (pose.used()) {
        TruthPoseTerm term = Term(pose);
        Whiten(robust ? poses_.RobustWeightOf(term.residual) : 1, &term);
        system->AddPose(*pose.state, term.residual, term.of_state, term.of_constants);
      }
    }
    return system->Factorize()
               ? Status::Ok()
               : Status::Diverged("refine_truth: the normal equations are not positive definite");
  }

  void AddPriors(ArrowSystem* system) const {
    Vector15d state_root = Vector15d::Zero();
    Vector15d state_error = Vector15d::Zero();
    state_root.segment<3>(9).setConstant(1);
    state_root.segment<3>(12).setConstant(0.1);
    state_error << Vector9d::Zero(), states_.front().bias.gyro, 0.1 * states_.front().bias.accel;
    system->AddPrior(0, state_error, state_root);
    ArrowSystem::Border root = ArrowSystem::Border::Ones();
    root.segment<3>(kLeverColumn).setConstant(0.1);
    root.segment<kScales>(kScaleColumn).setConstant(1 / (options_.imu_scale ? kScaleSigma : kHeldSigma));
    ArrowSystem::Border error = ArrowSystem::Border::Zero();
    error.segment<kScales>(kScaleColumn) << scale_.gyro, scale_.accel;
    error.segment<kScales>(kScaleColumn) *= root[kScaleColumn];
    error.segment<2>(kTiltColumn) = so3::Log(first_constants_.R_TW.transpose() * constants_.R_TW).head<2>();
    error.segment<3>(kMarkerColumn) =
        so3::Log(first_constants_.T_BM.rotation.transpose() * constants_.T_BM.rotation);
    error.segment<3>(kLeverColumn) = 0.1 * (constants_.T_BM.translation - first_constants_.T_BM.translation);
    error[kTimeColumn] = constants_.time_offset_s - first_constants_.time_offset_s;
    system->AddBorderPrior(error, root);
  }

  /// Moves states and constants to the minimum of the linearised problem and adds up the hat matrix.
  void Step(const ArrowSystem& system) {
    hat_ = {};
    auto pose = poses_.poses().crbegin();
    system.Solve([&](const ArrowSystem::Solution& solution) {
      for (; pose != poses_.poses().crend() && (!pose->state || *pose->state >= solution.k); ++pose) {
        if (pose->used()) {
          AddToHat(solution, system.border_covariance(), *pose);
        }
      }
      states_[solution.k] = Retract(states_[solution.k], solution.step);
    });
    constants_ = Retract(constants_, system.border_step().head<kTruthConstants>());
    const Eigen::Vector3d one = Eigen::Vector3d::Ones();
    const auto step = system.border_step().segment<kScales>(kScaleColumn);
    if (options_.imu_scale) {
      scale_.gyro = (one + scale_.gyro).cwiseProduct(one + step.head<3>()) - one;
      scale_.accel = (one + scale_.accel).cwiseProduct(one + step.tail<3>()) - one;
      ApplyScale();
    }
  }

  void ApplyScale() {
    scaled_.clear();
    for (const ImuSample& sample : imu_) {
      scaled_.push_back(scale_.Applied(sample));
    }
    SetCurvatures(scaled_);
  }

  /// Diagonal of J P J^T of a pose's rows, over orientation and position.
  void AddToHat(const ArrowSystem::Solution& solution, const ArrowSystem::BorderMatrix& border,
                const GatedPose& pose) {
    const TruthPoseTerm term = Term(pose);
    const Matrix6d mixed = term.of_state * solution.with_border * term.of_constants.transpose();
    const Matrix6d covariance = term.of_state * solution.covariance * term.of_state.transpose() + mixed +
                                mixed.transpose() +
                                term.of_constants * border * term.of_constants.transpose();
    hat_.orientation_rad += covariance.diagonal().segment<3>(kOrientationRow).sum();
    hat_.position_m += covariance.diagonal().segment<3>(kPositionRow).sum();
  }

  /// Residuals, refused poses and noise at the present states.
  void UpdateWeights(bool robust) {
    for (GatedPose& pose : poses_.poses()) {
      if (pose.state) {
        pose.residual = Term(pose).residual;
      }
    }
    if (robust) {
      poses_.EstimateRobustNoise();
    }
    changed_ = 0;
    if (result_.iterations >= kRobustIterations && result_.iterations < kGateIterations) {
      changed_ = poses_.Gate();
    }
    if (!robust) {
      const TruthNoise before = poses_.noise();
      poses_.EstimateNoise(hat_);
      poses_.SetNoise({orientation_noise_.Next(before.orientation_rad, poses_.noise().orientation_rad),
                       position_noise_.Next(before.position_m, poses_.noise().position_m)});
    }
  }

  [[nodiscard]] bool IsSettled(const ArrowSystem& system, const TruthNoise& before) const {
    return changed_ == 0 && system.newton_decrement() <= Square(kSettledSigma) &&
           std::abs(poses_.noise().orientation_rad / before.orientation_rad - 1) < kSettledNoise &&
           std::abs(poses_.noise().position_m / before.position_m - 1) < kSettledNoise;
  }

  /// Covariances and figures at the estimate.
  Result<RefinedTruth> Finish(ArrowSystem* system) {
    ALIDADE_RETURN_IF_ERROR(Linearize(false, system));
    result_.constants = constants_;
    result_.constants_covariance =
        system->border_covariance().topLeftCorner<kTruthConstants, kTruthConstants>();
    if (options_.imu_scale) {
      result_.imu_scale = scale_;
      result_.imu_scale_std =
          system->border_covariance().diagonal().segment<kScales>(kScaleColumn).cwiseMax(0).cwiseSqrt();
    }
    result_.distance_sigma = std::sqrt(system->newton_decrement());
    DescribePoses();
    const TruthSpan extent = poses_.Extent(constants_.time_offset_s);
    system->Solve([&](const ArrowSystem::Solution& solution) {
      const size_t k = solution.k;
      if (k + 1 < states_.size()) {
        AddImuFit(solution, system->border_covariance());
      }
      if (imu_[k].stamp_ns >= extent.from_ns && imu_[k].stamp_ns <= extent.to_ns) {
        result_.states.push_back({imu_[k].stamp_ns, states_[k].nav, states_[k].bias, solution.covariance});
      }
    });
    std::reverse(result_.states.begin(), result_.states.end());
    return std::move(result_);
  }

  void AddImuFit(const ArrowSystem::Solution& solution, const ArrowSystem::BorderMatrix& border) {
    const size_t k = solution.k;
    const std::optional<TruthLink> link =
        LinearizeLink(scaled_[k], scaled_[k + 1], states_[k], states_[k + 1], imu_model_);
    const Matrix15d mixed =
        link->of_first * solution.with_next * link->of_second.transpose() +
        (link->of_first * solution.with_border + link->of_second * solution.next_with_border +
         0.5 * link->of_constants * border) *
            link->of_constants.transpose();
    const Vector15d hat =
        (link->of_first * solution.covariance * link->of_first.transpose() +
         link->of_second * solution.next_covariance * link->of_second.transpose() + mixed + mixed.transpose())
            .diagonal();
    // The whitening is lower triangular: rows of a group are those given the groups before.
    const auto add = [&](int row, int rows, TruthFit* fit) {
      fit->chi_square += link->residual.segment(row, rows).squaredNorm();
      fit->dof += rows - hat.segment(row, rows).sum();
    };
    add(0, 3, &result_.gyro);
    add(3, 6, &result_.accel);
    add(9, 3, &result_.gyro_walk);
    add(12, 3, &result_.accel_walk);
  }

  void DescribePoses() {
    for (const GatedPose& pose : poses_.poses()) {
      result_.poses += pose.state ? 1 : 0;
      result_.refused += pose.state && !pose.passes ? 1 : 0;
    }
    result_.noise = poses_.noise();
    result_.orientation = poses_.orientation();
    result_.position = poses_.position();
    result_.noise_std = {result_.noise.orientation_rad / std::sqrt(2 * result_.orientation.dof),
                         result_.noise.position_m / std::sqrt(2 * result_.position.dof)};
    result_.orientation_correlation = poses_.OrientationCorrelation();
    result_.position_correlation = poses_.PositionCorrelation();
    result_.spans = poses_.Gaps(options_.max_gap_s, constants_.time_offset_s);
  }

  static double Square(double x) { return x * x; }

  TruthRefinementOptions options_;
  TruthImu imu_model_;
  std::span<const ImuSample> imu_;
  TruthImuScale scale_;
  std::vector<ImuSample> scaled_;  ///< imu_ times the factors
  TruthPoses poses_;
  std::vector<TruthState> states_;  ///< at the samples
  TruthConstants constants_, first_constants_;
  FixedPoint orientation_noise_, position_noise_;
  TruthNoise hat_;      ///< sums of the diagonal of J P J^T [rad^2, m^2]
  size_t changed_ = 0;  ///< verdicts of the gate
  RefinedTruth result_;
};

}  // namespace

Result<RefinedTruth> RefineTruth(std::span<const ImuSample> imu, std::span<const TruthPose> poses,
                                 const TruthRefinementOptions& options) {
  return Refinement(imu, poses, options).Execute();
}

}  // namespace alidade
