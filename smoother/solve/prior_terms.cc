#include "smoother/solve/prior_terms.h"

#include <utility>

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
      cost_(&slam_) {
  for (int i = 0; i < window.size(); ++i) {
    AddPart({Unknown::Kind::kFrame, i}, slam_.columns().Frame(i).size);
  }
  AddPart({Unknown::Kind::kClock, 0}, slam_.columns().Clock(0).size);
  AddPart({Unknown::Kind::kCalibration, 0}, calibration.size());
}

const Eigen::VectorXd* SlamPriorTerm::Landmarks() const {
  return cost_.LandmarksAt(PointOf(*window_, calibration_->mean));
}

Status SlamPriorTerm::Linearize(LinearTerm* linear) const {
  NormalEquations equations;
  if (Landmarks() == nullptr || !cost_.Linearize(&equations)) {
    return Status::Diverged("smoother: landmarks at " + FormatSeconds(window_->newest().stamp_ns) +
                            " s have no solution");
  }
  linear->SetInformation(parts(), std::move(equations));
  return Status::Ok();
}

}  // namespace alidade
