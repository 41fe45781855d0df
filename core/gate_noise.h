#pragma once

#include <vector>

#include "core/time.h"
#include "core/vision_config.h"

namespace alidade {

/// The pixel noise that the gate of tracks takes, as a share of the noise their rows are weighed by: 1, or
/// (GateNoiseModel::kAdaptive) lowered to what most tracks show.
///
/// A given noise has to cover errors of tracks that are correlated in time, so it is often several times
/// larger than what one track scatters by. A gate of that width lets tracks pass that slide along an
/// occlusion or a reflection, and those bias the scale (docs/estimators.md). The median over tracks of
/// nis / median(chi-square, dof), with nis taken at the gate's noise, is 1 where that noise is right, and
/// does not depend on the tracks in the tail. With u the share in use, over sets of at least twenty tracks,
///
///     log e^2 += (1 - exp(-dt / 2 s)) (log(u^2 median) - log e^2),   u = min(1, 1.25 e).
///
/// So nothing changes where the given noise is that of the tracks.
class GateNoise {
 public:
  explicit GateNoise(const VisionConfig& config);

  /// Variance at the gate over that of the weights, in (0, 1].
  [[nodiscard]] double variance() const { return variance_; }
  [[nodiscard]] bool lowered() const { return variance_ < 1; }
  /// The given noise again; what most tracks show is then found anew.
  void Reset();
  /// A track, whether it passes or not; `nis`: its normalised innovation squared at the gate's noise.
  void AddTrack(double nis, int dof);
  /// Ends the frame exposed at `stamp_ns`.
  void EndFrame(TimeNs stamp_ns);

 private:
  bool adaptive_;
  double least_;             ///< lowest deviation, over the given one
  double log_estimate_ = 0;  ///< log e^2
  double variance_ = 1;      ///< u^2
  std::vector<double> ratios_;
  TimeNs last_ns_ = INT64_MIN;
};

}  // namespace alidade
