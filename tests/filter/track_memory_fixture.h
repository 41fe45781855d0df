#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/visual_observation.h"
#include "filter/feature_update.h"
#include "filter/track_memory.h"
#include "tests/support/cloned_window.h"
#include "tests/support/scenario.h"

namespace alidade::test {

/// The landmark seen by the estimated clones [first, last), without noise.
inline Track SeenFromClones(const FilterState& state, const Eigen::Vector3d& p_W, size_t first, size_t last) {
  Track track;
  for (size_t i = first; i < last; ++i) {
    const Clone& clone = state.clones()[i];
    TrackView view;
    view.serial = clone.serial;
    view.observation.z = (clone.T_WC.rotation.transpose() * (p_W - clone.T_WC.translation)).hnormalized();
    view.observation.sqrt_information = 400 * Eigen::Matrix2d::Identity();
    track.views.push_back(view);
  }
  track.last_serial = track.views.back().serial;
  return track;
}

inline FilterConfig Remembering(ErrorConvention convention) {
  FilterConfig config;
  config.error = convention;
  config.track_memory = TrackMemoryPolicy::kCarry;
  config.memory_depth_deviation = 1;
  return config;
}

/// In every convention.
class TrackMemoryFixture : public ::testing::TestWithParam<ErrorConvention> {
 protected:
  TrackMemoryFixture() : dataset_(SimulateOrDie(SimulatorConfig(), 1)) {}

  /// A point some metres in front of the first camera.
  [[nodiscard]] static Eigen::Vector3d PointBefore(const FilterState& state) {
    return state.clones().front().T_WC * Eigen::Vector3d(0.5, -0.3, 4);
  }

  Dataset dataset_;
  VisionConfig vision_{.max_relative_depth_deviation = 10};
};

inline auto AllMemoryConventions() {
  return testing::Values(ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant,
                         ErrorConvention::kSo3xRn);
}

inline std::string NameOfConvention(const testing::TestParamInfo<ErrorConvention>& item) {
  return std::string(ToString(item.param));
}

}  // namespace alidade::test
