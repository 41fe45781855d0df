#include "eval/calibrate/block_scatter.h"

#include <cmath>
#include <map>

namespace alidade {

std::optional<CameraGyroError> VariancesByBlocks(const std::vector<FramePair>& pairs,
                                                 const CameraGyroMatrix& covariance,
                                                 const std::vector<CameraGyroError>& gradients,
                                                 const CameraGyroError& prior, double block_s) {
  constexpr std::size_t kLeastBlocks = 4;
  std::map<long, CameraGyroError> blocks;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const long block = std::lround((pairs[k].t_i_s - pairs.front().t_i_s) / block_s - 0.5);
    blocks.try_emplace(block, CameraGyroError::Zero()).first->second += gradients[k];
  }
  if (blocks.size() < kLeastBlocks) {
    return std::nullopt;
  }
  CameraGyroError squares = CameraGyroError::Zero();
  for (auto& [block, of_block] : blocks) {
    for (int c = 0; c < CameraGyroCoordinate::kCount; ++c) {
      of_block[c] = prior[c] > 0 ? of_block[c] : 0;
    }
    squares += (covariance * of_block).cwiseAbs2();
  }
  // The blocks' gradients sum to about zero at the estimate, and the scatter of a few blocks is uncertain.
  const auto count = static_cast<double>(blocks.size());
  return squares * ((count + 2) / (count - 1));
}

}  // namespace alidade
