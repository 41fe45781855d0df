#include "smoother/solve/prior_terms.h"

#include "smoother/solve/factor_term.h"

namespace alidade {

std::unique_ptr<WindowTerm> MakePriorTerm(const LinearPrior& prior, const WindowCalibration& calibration) {
  std::vector<TermBlock> blocks;
  for (const LinearPrior::Anchor& anchor : prior.anchors) {
    blocks.push_back(NavBlock(*anchor.frame));
    if (blocks.size() == 1) {
      blocks.push_back(BiasBlock(*anchor.frame));
    } else {
      blocks.back().width = kPoseColumns;  // it has no velocity of these frames
    }
  }
  if (prior.clock_origin) {
    blocks.push_back(ClockBlock(*prior.anchors.front().frame));
  }
  blocks.push_back(CalibrationBlock(calibration));
  return MakeTerm(PriorFactor(&prior, &calibration), std::move(blocks));
}

SlamPriorTerm::SlamPriorTerm(const LinearPrior& prior, const Window& window,
                             const WindowCalibration& calibration, const ObservationKernel& kernel)
    : window_(&window),
      calibration_(&calibration),
      slam_(&prior, PriorTracks(prior, window), window, calibration, kernel),
      cost_(SlamPriorFactor(&slam_, window.size())) {
  for (int i = 0; i < window.size(); ++i) {
    AddPart({Unknown::Kind::kFrame, i}, slam_.columns().Frame(i).size);
  }
  AddPart({Unknown::Kind::kClock, 0}, slam_.columns().Clock(0).size);
  AddPart({Unknown::Kind::kCalibration, 0}, calibration.size());
}

const SlamPriorTerm::Solution& SlamPriorTerm::Solve() const {
  if (!solution_) {
    solution_ = Solution();
    solution_->landmarks = slam_.StartingLandmarks();
    solution_->valid =
        slam_.Reduce(PointOf(*window_, calibration_->mean), &solution_->landmarks, &solution_->reduced);
  }
  return *solution_;
}

const Eigen::VectorXd* SlamPriorTerm::Landmarks() const {
  return Solve().valid ? &Solve().landmarks : nullptr;
}

Status SlamPriorTerm::Linearize(LinearTerm* linear) const {
  if (!Solve().valid) {
    return Status::Diverged("smoother: landmarks at " + FormatSeconds(window_->newest().stamp_ns) +
                            " s have no solution");
  }
  linear->SetInformation(parts(), Solve().reduced.hessian, Solve().reduced.gradient);
  return Status::Ok();
}

void SlamPriorTerm::AddTo(ParameterBlocks* blocks, ceres::Problem* problem) {
  std::vector<double*> parameters = {blocks->Nav(0), blocks->Bias(0)};
  for (int i = 1; i < window_->size(); ++i) {
    parameters.push_back(blocks->Nav(i));
  }
  if (slam_.prior().clock_origin) {
    parameters.push_back(blocks->Clock(0));
  }
  parameters.push_back(blocks->Calibration());
  problem->AddResidualBlock(&cost_, nullptr, parameters);
}

}  // namespace alidade
