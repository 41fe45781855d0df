#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/rig_calibration.h"
#include "core/track_frame.h"

namespace alidade {

/// Median squared distance of the common tracks of two frames to the epipolar plane of the best direction of
/// translation (Kneip and Lynen 2013; frontend/initialization/epipolar_ray.h), in its variance, when the body
/// turned by R_ab between them: one in the mean for the right turn. Nothing with fewer than 12 common tracks.
/// `pixel_noise_px`: of an observation.
[[nodiscard]] std::optional<double> TurnMisfit(const RigCalibration& rig, double pixel_noise_px,
                                               const TrackFrame& a, const TrackFrame& b,
                                               const Eigen::Matrix3d& R_ab);

/// What the misfits of two turns show: that by the stamps as they are, and that by a clock that jumped.
enum class ClockVerdict {
  kUnknown,  ///< the stamps as they are give no misfit
  kOpen,     ///< neither fits much better
  kHolds,    ///< the stamps are right
  kJumped,
};
/// `contrast`: how much larger the misfit of the explanation that is rejected must be; the default is for one
/// pair of frames that decides alone.
[[nodiscard]] ClockVerdict CompareTurns(const std::optional<double>& as_is,
                                        const std::optional<double>& jumped, double contrast = 10);

/// The verdict of frames in a row: one of high contrast decides alone, kFrames that agree decide with less.
class ClockVotes {
 public:
  static constexpr int kFrames = 4;
  static constexpr double kContrast = 2;  ///< CompareTurns

  [[nodiscard]] ClockVerdict Add(const std::optional<double>& as_is, const std::optional<double>& jumped);

 private:
  ClockVerdict last_ = ClockVerdict::kOpen;
  int in_a_row_ = 0;
};

}  // namespace alidade
