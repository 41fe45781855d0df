#include "smoother/solve/solve_store.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

std::unique_ptr<ceres::LossFunction> MakeLoss(const ObservationKernel& kernel) {
  switch (kernel.kernel) {
    case RobustKernel::kHuber:
      return std::make_unique<ceres::HuberLoss>(kernel.scale_sigma);
    case RobustKernel::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(kernel.scale_sigma);
    case RobustKernel::kNone:
      break;
  }
  return nullptr;
}

}  // namespace

SolveStore::SolveStore(ErrorConvention error, const ObservationKernel& kernel, const Frames& frames,
                       const std::vector<WindowTrack*>& tracks, const WindowCalibration* calibration)
    : frames_(frames),
      tracks_(tracks),
      calibration_(calibration),
      has_clocks_(frames.front()->clock.has_value()),
      parameters_(kFrameStride * frames.size() + kLandmarkStride * tracks.size() +
                  (has_clocks_ ? kClockStride * frames.size() : 0) +
                  (calibration != nullptr ? kCalibrationStride : 0)),
      manifold_(error),
      kernel_(kernel),
      loss_(MakeLoss(kernel)) {
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    std::copy(frame->nav.begin(), frame->nav.end(), Nav(frame->index));
    std::copy(frame->bias.begin(), frame->bias.end(), Bias(frame->index));
    if (has_clocks_) {
      std::copy(frame->clock->begin(), frame->clock->end(), Clock(frame->index));
    }
  }
  for (size_t i = 0; i < tracks.size(); ++i) {
    std::copy_n(tracks[i]->landmark.data(), 3, Landmark(i));
  }
}

std::unique_ptr<ceres::Problem> SolveStore::MakeProblem() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  auto problem = std::make_unique<ceres::Problem>(options);
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    problem->AddParameterBlock(Nav(frame->index), kNavAmbientSize, &manifold_);
    problem->AddParameterBlock(Bias(frame->index), 6);
    if (has_clocks_) {
      problem->AddParameterBlock(Clock(frame->index), ClockState::kSize);
    }
  }
  if (calibration_ != nullptr) {
    std::vector<int> fixed;
    for (int i = calibration_->size(); i < CalibrationLayout::kMaxSize; ++i) {
      fixed.push_back(i);
    }
    calibration_manifold_ = std::make_unique<ceres::SubsetManifold>(CalibrationLayout::kMaxSize, fixed);
    problem->AddParameterBlock(Calibration(), CalibrationLayout::kMaxSize, calibration_manifold_.get());
  }
  return problem;
}

void SolveStore::AddPrior(const LinearPrior& prior, ceres::Problem* problem) {
  prior_.emplace(PriorFactor(&prior, calibration_));
  std::vector<double*> blocks;
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    blocks.push_back(Nav(prior.anchors[i].frame->index));
    if (i == 0) {
      blocks.push_back(Bias(prior.anchors[i].frame->index));
    }
  }
  if (prior.clock_origin) {
    blocks.push_back(Clock(prior.anchors.front().frame->index));
  }
  if (calibration_ != nullptr) {
    blocks.push_back(Calibration());
  }
  problem->AddResidualBlock(&*prior_, nullptr, blocks);
}

void SolveStore::AddSlamPrior(const SlamPrior& prior, ceres::Problem* problem) {
  const int frames = static_cast<int>(frames_.size());
  slam_prior_.emplace(SlamPriorFactor(&prior, frames));
  std::vector<double*> blocks = {Nav(0), Bias(0)};
  for (int i = 1; i < frames; ++i) {
    blocks.push_back(Nav(i));
  }
  if (has_clocks_) {
    blocks.push_back(Clock(0));
  }
  if (calibration_ != nullptr) {
    blocks.push_back(Calibration());
  }
  problem->AddResidualBlock(&*slam_prior_, nullptr, blocks);
}

Status SolveStore::AddImu(const Eigen::Vector3d& gravity_W, ceres::Problem* problem) {
  for (size_t i = 0; i + 1 < frames_.size(); ++i) {
    const WindowFrame& next = *frames_[i + 1];
    const ImuFactor factor(&*next.preintegration, gravity_W, frames_[i]->first_estimate(),
                           next.first_estimate());
    if (!factor.valid()) {
      return Status::Diverged("smoother: IMU covariance up to " + FormatSeconds(next.stamp_ns) +
                              " s is not positive definite; the four noise densities must be positive");
    }
    imu_.emplace_back(factor);
    const int from = static_cast<int>(i);
    problem->AddResidualBlock(&imu_.back(), nullptr, Nav(from), Bias(from), Nav(from + 1), Bias(from + 1));
  }
  return Status::Ok();
}

void SolveStore::AddRest(ceres::Problem* problem) {
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    if (frame->rest) {
      rest_.emplace_back(RestFactor(*frame->rest));
      problem->AddResidualBlock(&rest_.back(), nullptr, Nav(frame->index), Bias(frame->index));
    }
  }
}

void SolveStore::AddGnss(const GnssFactorContext& context, ceres::Problem* problem) {
  GnssResiduals ignored;
  for (size_t i = 0; i < frames_.size(); ++i) {
    const WindowFrame& frame = *frames_[i];
    const int index = static_cast<int>(i);
    for (const FrameEpoch& epoch : frame.epochs) {
      const double dt_s = epoch.SecondsAfter(frame.stamp_ns);
      const FrameEpochRows rows = LinearizeFrameEpoch(context, epoch, dt_s, frame.nav_state(),
                                                      frame.imu_bias(), frame.clock_state(), true, &ignored);
      if (rows.residual.size() == 0) {
        continue;
      }
      gnss_.emplace_back(GnssEpochFactor(&context, &epoch, dt_s, static_cast<int>(rows.residual.size())));
      problem->AddResidualBlock(&gnss_.back(), nullptr, Nav(index), Bias(index), Clock(index));
    }
    if (i + 1 < frames_.size()) {
      const WindowFrame& next = *frames_[i + 1];
      clock_.emplace_back(ClockFactor(
          ClockStep(context.config, SecondsBetween(frame.stamp_ns, next.stamp_ns), next.clock_anew)));
      problem->AddResidualBlock(&clock_.back(), nullptr, Clock(index), Clock(index + 1));
    }
  }
}

void SolveStore::AddInverseDepth(const Pose& T_BC, ceres::Problem* problem) {
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const std::vector<WindowView>& views = tracks_[i]->views;
    if (calibration_ != nullptr && calibration_->layout.intrinsics() >= 0) {
      base_bearing_.emplace_back(BaseBearingFactor(&views.front(), calibration_));
      problem->AddResidualBlock(&base_bearing_.back(), loss_.get(), Landmark(i), Calibration());
    } else {
      base_bearing_.emplace_back(BaseBearingFactor(views.front().observation));
      problem->AddResidualBlock(&base_bearing_.back(), loss_.get(), Landmark(i));
    }
    if (tracks_[i]->depth_prior.sqrt_information > 0) {
      depth_prior_.emplace_back(DepthPriorFactor(tracks_[i]->depth_prior));
      problem->AddResidualBlock(&depth_prior_.back(), nullptr, Landmark(i));
    }
    for (size_t k = 1; k < views.size(); ++k) {
      double* const base = Nav(views.front().frame->index);
      double* const view = Nav(views[k].frame->index);
      if (calibration_ != nullptr) {
        inverse_depth_.emplace_back(InverseDepthFactor(views.front().frame, &views[k], calibration_));
        problem->AddResidualBlock(&inverse_depth_.back(), loss_.get(), base, view, Landmark(i),
                                  Calibration());
      } else {
        inverse_depth_.emplace_back(InverseDepthFactor(views.front().frame, &views[k], &T_BC));
        problem->AddResidualBlock(&inverse_depth_.back(), loss_.get(), base, view, Landmark(i));
      }
    }
  }
}

void SolveStore::AddPoseOnly(const Window& window, const Pose& T_BC, ceres::Problem* problem) {
  std::vector<double*> blocks;
  for (int i = 0; i < window.size(); ++i) {
    blocks.push_back(Nav(i));
  }
  std::vector<const WindowTrack*> tracks(tracks_.begin(), tracks_.end());
  if (calibration_ != nullptr) {
    blocks.push_back(Calibration());
    pose_only_.emplace(PoseOnlyFactor(window, std::move(tracks), *calibration_, kernel_));
  } else {
    pose_only_.emplace(PoseOnlyFactor(window, std::move(tracks), T_BC, kernel_));
  }
  problem->AddResidualBlock(&*pose_only_, nullptr, blocks);
}

bool SolveStore::IsFinite() const {
  return std::all_of(parameters_.begin(), parameters_.end(),
                     [](double value) { return std::isfinite(value); });
}

void SolveStore::WriteBack() const {
  const double* block = parameters_.data();
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    std::copy_n(block, kNavAmbientSize, frame->nav.begin());
    std::copy_n(block + kNavAmbientSize, 6, frame->bias.begin());
    block += kFrameStride;
  }
  for (WindowTrack* track : tracks_) {
    std::copy_n(block, 3, track->landmark.data());
    block += kLandmarkStride;
  }
  for (size_t i = 0; has_clocks_ && i < frames_.size(); ++i) {
    std::copy_n(block, kClockStride, frames_[i]->clock->begin());
    block += kClockStride;
  }
}

}  // namespace alidade
