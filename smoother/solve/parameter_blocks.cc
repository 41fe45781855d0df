#include "smoother/solve/parameter_blocks.h"

#include <algorithm>
#include <cmath>

namespace alidade {

ParameterBlocks::ParameterBlocks(ErrorConvention error, const WindowFrames& frames,
                                 const std::vector<WindowTrack*>& tracks,
                                 const WindowCalibration& calibration)
    : frames_(frames),
      tracks_(tracks),
      calibration_(calibration),
      has_clocks_(frames.front()->clock.has_value()),
      parameters_(kFrameStride * frames.size() + kLandmarkStride * tracks.size() +
                  (has_clocks_ ? kClockStride * frames.size() : 0) + kCalibrationStride),
      manifold_(error, frames.back()->nav_state().p_WB, frames.back()->nav_state().v_WB) {
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    std::copy(frame->nav.begin(), frame->nav.end(), Nav(frame->index));
    std::copy(frame->bias.begin(), frame->bias.end(), Bias(frame->index));
    if (has_clocks_) {
      std::copy(frame->clock->begin(), frame->clock->end(), Clock(frame->index));
    }
  }
  for (size_t i = 0; i < tracks.size(); ++i) {
    std::copy_n(tracks[i]->landmark.data(), 3, Landmark(static_cast<int>(i)));
  }
}

double* ParameterBlocks::Find(BlockKind kind, int index) {
  switch (kind) {
    case BlockKind::kNavState:
      return Nav(index);
    case BlockKind::kBias:
      return Bias(index);
    case BlockKind::kClock:
      return Clock(index);
    case BlockKind::kCalibration:
      return Calibration();
    case BlockKind::kLandmark:
      break;
  }
  return Landmark(index);
}

std::unique_ptr<ceres::Problem> ParameterBlocks::MakeProblem(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = callback;
  auto problem = std::make_unique<ceres::Problem>(options);
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    problem->AddParameterBlock(Nav(frame->index), kNavAmbientSize, &manifold_);
    problem->AddParameterBlock(Bias(frame->index), AmbientSize(BlockKind::kBias));
    if (has_clocks_) {
      problem->AddParameterBlock(Clock(frame->index), ClockState::kSize);
    }
  }
  std::vector<int> fixed;
  for (int i = calibration_.size(); i < CalibrationLayout::kMaxSize; ++i) {
    fixed.push_back(i);
  }
  calibration_manifold_ = std::make_unique<ceres::SubsetManifold>(CalibrationLayout::kMaxSize, fixed);
  problem->AddParameterBlock(Calibration(), CalibrationLayout::kMaxSize, calibration_manifold_.get());
  return problem;
}

bool ParameterBlocks::PointAt(WindowPoint* point) {
  point->states.clear();
  for (int i = 0; i < frames(); ++i) {
    point->states.push_back(UnpackNavState(Nav(i)));
  }
  point->bias = UnpackBias(Bias(0));
  if (has_clocks_) {
    point->clock = Eigen::Map<const Vector6d>(Clock(0));
  }
  return calibration_.At(Calibration(), &point->camera);
}

bool ParameterBlocks::IsFinite() const {
  return std::all_of(parameters_.begin(), parameters_.end(),
                     [](double value) { return std::isfinite(value); });
}

void ParameterBlocks::WriteBack() const {
  const double* block = parameters_.data();
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    std::copy_n(block, kNavAmbientSize, frame->nav.begin());
    std::copy_n(block + kNavAmbientSize, frame->bias.size(), frame->bias.begin());
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
