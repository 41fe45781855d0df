#include "smoother/truth/refined_truth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/imu_propagation.h"
#include "smoother/truth/fixed_point.h"
#include "smoother/truth/truth_unknowns.h"

namespace alidade {
namespace {

constexpr size_t kMinPoses = 10;
constexpr int kRobustIterations = 4;
constexpr int kGateIterations = 15;  // of the poses; afterwards they are held
constexpr int kMaxIterations = 40;
constexpr double kSettledSigma = 0.01;
constexpr double kSettledNoise = 1e-4;  // relative
constexpr int kOrientationRow = 0;
constexpr int kPositionRow = 3;

class Refinement {
 public:
  Refinement(std::span<const ImuSample> imu, std::span<const TruthPose> poses,
             const TruthRefinementOptions& options)
      : options_(options),
        imu_(imu),
        unknowns_({options.imu_noise, GravityInWorld(options.gravity_mps2)}, options.imu_scale),
        poses_(poses, options.gate_probability, options.noise) {}

  Result<RefinedTruth> Execute() {
    ALIDADE_RETURN_IF_ERROR(Begin());
    ArrowSystem system(unknowns_.states().size());
    for (result_.iterations = 1; result_.iterations <= kMaxIterations; ++result_.iterations) {
      if (options_.stop != nullptr && options_.stop->load()) {
        return Status::Diverged("refine_truth: interrupted");
      }
      const TruthNoise before = poses_.noise();
      const bool robust = result_.iterations <= kRobustIterations;
      ALIDADE_RETURN_IF_ERROR(Linearize(robust, &system));
      Step(system);
      poses_.Attach(unknowns_.imu(), unknowns_.constants().time_offset_s);
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
    unknowns_.Begin(imu_, StartTruth(imu_, poses), poses_.poses().front().pose.stamp_ns,
                    poses_.poses().back().pose.stamp_ns);
    result_.imu_gaps = unknowns_.CountImuGaps();
    poses_.Attach(unknowns_.imu(), unknowns_.constants().time_offset_s);
    return Status::Ok();
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
    unknowns_.AddPriors(system);
    for (size_t k = 0; k + 1 < unknowns_.states().size(); ++k) {
      const std::optional<TruthLink> link = unknowns_.Link(k);
      if (!link) {
        return Status::Input("refine_truth: the IMU sample at " + FormatSeconds(unknowns_.imu()[k].stamp_ns) +
                             " s is not finite or its noise is singular");
      }
      system->AddLink(k, link->residual, link->of_first, link->of_second, link->of_constants);
    }
    for (const GatedPose& pose : poses_.poses()) {
      if (pose.used()) {
        TruthPoseTerm term = unknowns_.Term(pose);
        Whiten(robust ? poses_.RobustWeightOf(term.residual) : 1, &term);
        system->AddPose(*pose.state, term.residual, term.of_state, term.of_constants);
      }
    }
    return system->Factorize()
               ? Status::Ok()
               : Status::Diverged("refine_truth: the normal equations are not positive definite");
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
      unknowns_.MoveState(solution);
    });
    unknowns_.MoveConstants(system.border_step());
  }

  /// Diagonal of J P J^T of a pose's rows, over orientation and position.
  void AddToHat(const ArrowSystem::Solution& solution, const ArrowSystem::BorderMatrix& border,
                const GatedPose& pose) {
    const TruthPoseTerm term = unknowns_.Term(pose);
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
        pose.residual = unknowns_.Term(pose).residual;
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
    result_.constants = unknowns_.constants();
    result_.constants_covariance =
        system->border_covariance().topLeftCorner<kTruthConstants, kTruthConstants>();
    if (options_.imu_scale) {
      result_.imu_scale = unknowns_.scale();
      result_.imu_scale_std =
          system->border_covariance().diagonal().segment<kScales>(kScaleColumn).cwiseMax(0).cwiseSqrt();
    }
    result_.distance_sigma = std::sqrt(system->newton_decrement());
    DescribePoses();
    const TruthSpan extent = poses_.Extent(unknowns_.constants().time_offset_s);
    system->Solve([&](const ArrowSystem::Solution& solution) {
      const size_t k = solution.k;
      if (k + 1 < unknowns_.states().size()) {
        AddImuFit(solution, system->border_covariance());
      }
      const TimeNs stamp_ns = unknowns_.imu()[k].stamp_ns;
      if (stamp_ns >= extent.from_ns && stamp_ns <= extent.to_ns) {
        const TruthState& state = unknowns_.states()[k];
        result_.states.push_back({stamp_ns, state.nav, state.bias, solution.covariance});
      }
    });
    std::reverse(result_.states.begin(), result_.states.end());
    return std::move(result_);
  }

  void AddImuFit(const ArrowSystem::Solution& solution, const ArrowSystem::BorderMatrix& border) {
    const std::optional<TruthLink> link = unknowns_.Link(solution.k);
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
    result_.spans = poses_.Gaps(options_.max_gap_s, unknowns_.constants().time_offset_s);
  }

  static double Square(double x) { return x * x; }

  TruthRefinementOptions options_;
  std::span<const ImuSample> imu_;  ///< all samples
  TruthUnknowns unknowns_;
  TruthPoses poses_;
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
