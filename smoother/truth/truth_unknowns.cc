#include "smoother/truth/truth_unknowns.h"

#include <algorithm>
#include <cstddef>

#include "core/imu_step.h"

namespace alidade {
namespace {

// Samples kept before the first and after the last pose: the time offset moves the poses.
constexpr double kMarginSeconds = 0.1;
constexpr double kImuGapSteps = 10;
constexpr double kScaleSigma = 0.02;  // of an inertial sensor's sheet
constexpr double kHeldSigma = 1e-8;   // of what is not estimated

}  // namespace

void TruthUnknowns::Begin(std::span<const ImuSample> imu, const TruthStart& start, TimeNs first_pose_ns,
                          TimeNs last_pose_ns) {
  imu_ = imu;
  constants_ = first_constants_ = start.constants;
  CutSamples(start.states, first_pose_ns, last_pose_ns);
  ApplyScale();
}

void TruthUnknowns::CutSamples(const std::vector<TruthState>& states, TimeNs first_pose_ns,
                               TimeNs last_pose_ns) {
  const TimeNs offset_ns = SecondsToNs(constants_.time_offset_s);
  const TimeNs first_ns = first_pose_ns + offset_ns - SecondsToNs(kMarginSeconds);
  const TimeNs last_ns = last_pose_ns + offset_ns + SecondsToNs(kMarginSeconds);
  size_t begin = 0;
  while (begin + 2 < imu_.size() && imu_[begin + 1].stamp_ns <= first_ns) {
    ++begin;
  }
  size_t end = imu_.size();
  while (end > begin + 2 && imu_[end - 2].stamp_ns >= last_ns) {
    --end;
  }
  imu_ = imu_.subspan(begin, end - begin);
  states_.assign(states.begin() + static_cast<std::ptrdiff_t>(begin),
                 states.begin() + static_cast<std::ptrdiff_t>(end));
}

int TruthUnknowns::CountImuGaps() const {
  std::vector<TimeNs> steps;
  for (size_t i = 1; i < imu_.size(); ++i) {
    steps.push_back(imu_[i].stamp_ns - imu_[i - 1].stamp_ns);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double limit = kImuGapSteps * static_cast<double>(*middle);
  return static_cast<int>(std::count_if(steps.begin(), steps.end(),
                                        [&](TimeNs step) { return static_cast<double>(step) > limit; }));
}

std::optional<TruthLink> TruthUnknowns::Link(size_t k) const {
  return LinearizeLink(scaled_[k], scaled_[k + 1], states_[k], states_[k + 1], model_);
}

TruthPoseTerm TruthUnknowns::Term(const GatedPose& pose) const {
  const size_t i = *pose.state;
  return LinearizePose(pose.pose.T_TM, pose.pose.stamp_ns + SecondsToNs(constants_.time_offset_s), scaled_[i],
                       scaled_[i + 1], states_[i], constants_, model_);
}

void TruthUnknowns::AddPriors(ArrowSystem* system) const {
  Vector15d state_root = Vector15d::Zero();
  Vector15d state_error = Vector15d::Zero();
  state_root.segment<3>(9).setConstant(1);
  state_root.segment<3>(12).setConstant(0.1);
  state_error << Vector9d::Zero(), states_.front().bias.gyro, 0.1 * states_.front().bias.accel;
  system->AddPrior(0, state_error, state_root);
  ArrowSystem::Border root = ArrowSystem::Border::Ones();
  root.segment<3>(kLeverColumn).setConstant(0.1);
  root.segment<kScales>(kScaleColumn).setConstant(1 / (imu_scale_ ? kScaleSigma : kHeldSigma));
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

void TruthUnknowns::MoveState(const ArrowSystem::Solution& solution) {
  states_[solution.k] = Retract(states_[solution.k], solution.step);
}

void TruthUnknowns::MoveConstants(const ArrowSystem::Border& border_step) {
  constants_ = Retract(constants_, border_step.head<kTruthConstants>());
  const Eigen::Vector3d one = Eigen::Vector3d::Ones();
  const auto step = border_step.segment<kScales>(kScaleColumn);
  if (imu_scale_) {
    scale_.gyro = (one + scale_.gyro).cwiseProduct(one + step.head<3>()) - one;
    scale_.accel = (one + scale_.accel).cwiseProduct(one + step.tail<3>()) - one;
    ApplyScale();
  }
}

void TruthUnknowns::ApplyScale() {
  scaled_.clear();
  for (const ImuSample& sample : imu_) {
    scaled_.push_back(scale_.Applied(sample));
  }
  SetCurvatures(scaled_);
}

}  // namespace alidade
