#include "smoother/solve/factor_term.h"

#include <array>

#include "core/check.h"
#include "smoother/solve/window_problem.h"

namespace alidade {
namespace {

// A calibration's block holds the error of the present mean.
constexpr std::array<double, CalibrationLayout::kMaxSize> kNoError{};

Unknown UnknownOf(const TermBlock& block) {
  switch (block.kind) {
    case BlockKind::kClock:
      return {Unknown::Kind::kClock, block.index};
    case BlockKind::kCalibration:
      return {Unknown::Kind::kCalibration, 0};
    case BlockKind::kLandmark:
      return {Unknown::Kind::kLandmark, block.index};
    case BlockKind::kNavState:
    case BlockKind::kBias:
      break;
  }
  return {Unknown::Kind::kFrame, block.index};
}

}  // namespace

TermBlock NavBlock(const WindowFrame& frame) {
  return {BlockKind::kNavState, frame.index, frame.nav.data(), kNavColumns};
}
TermBlock BiasBlock(const WindowFrame& frame) {
  return {BlockKind::kBias, frame.index, frame.bias.data(), kBiasColumns};
}
TermBlock ClockBlock(const WindowFrame& frame) {
  return {BlockKind::kClock, frame.index, frame.clock->data(), kClockColumns};
}
TermBlock LandmarkBlock(const WindowTrack& track, int landmark) {
  return {BlockKind::kLandmark, landmark, track.landmark.data(), kLandmarkColumns};
}
TermBlock CalibrationBlock(const WindowCalibration& calibration) {
  return {BlockKind::kCalibration, 0, kNoError.data(), calibration.size()};
}

FactorBlocks::FactorBlocks(std::vector<TermBlock> blocks) : blocks_(std::move(blocks)) {
  for (size_t i = 0; i < blocks_.size(); ++i) {
    const TermBlock& block = blocks_[i];
    const bool with_bias = block.kind == BlockKind::kNavState && i + 1 < blocks_.size() &&
                           blocks_[i + 1].kind == BlockKind::kBias;
    CHECK(block.kind != BlockKind::kBias) << "a bias follows the navigation state of its frame";
    AddPart(UnknownOf(block), with_bias ? kStateColumns : block.width);
    if (with_bias) {
      ++i;
      CHECK_EQ(blocks_[i].index, block.index);
    }
  }
}

void FactorBlocks::AddTo(WindowProblem* problem) {
  std::vector<double*> parameters;
  for (const TermBlock& block : blocks_) {
    parameters.push_back(problem->blocks().Find(block.kind, block.index));
  }
  problem->ceres().AddResidualBlock(cost(), nullptr, parameters);
}

std::vector<const double*> FactorBlocks::Present() const {
  std::vector<const double*> present;
  for (const TermBlock& block : blocks_) {
    present.push_back(block.present);
  }
  return present;
}

std::vector<double*> FactorBlocks::Spread(int rows, std::vector<double>* tangents) const {
  int width = 0;
  for (const TermBlock& block : blocks_) {
    width += TangentSize(block.kind);
  }
  tangents->resize(static_cast<size_t>(rows) * static_cast<size_t>(width));
  std::vector<double*> jacobians;
  double* at = tangents->data();
  for (const TermBlock& block : blocks_) {
    jacobians.push_back(at);
    at += rows * TangentSize(block.kind);
  }
  return jacobians;
}

void FactorBlocks::Gather(const std::vector<double>& tangents, LinearTerm* linear) const {
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index rows = linear->residual.size();
  const double* at = tangents.data();
  Eigen::Index column = 0;
  for (const TermBlock& block : blocks_) {
    const Eigen::Map<const RowMatrix> tangent(at, rows, TangentSize(block.kind));
    linear->jacobian.middleCols(column, block.width) = tangent.leftCols(block.width);
    column += block.width;
    at += tangent.size();
  }
}

}  // namespace alidade
