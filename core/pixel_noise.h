#pragma once

#include "core/time.h"
#include "core/track_frame.h"
#include "core/vision_config.h"

namespace alidade {

/// The pixel noise that an estimator takes: as given, or (PixelNoiseModel::kAdaptive) raised while the
/// innovations of its tracks are larger than predicted. Tracks are those the chi-square gate lets pass; with
/// sums over those of a frame,
///
///     v = s^2 sum nis / sum dof,    m += (1 - exp(-dt / 20 s)) (v - m),
///
/// and the factor s on the deviation follows sqrt(max(1, m)) by at most 1 % a second. So it never falls below
/// the given noise, and a fault of some seconds moves it by some per cent, whatever it does to the
/// innovations. Frames with fewer than ten rows, or whose state is suspect (core/robust.h), are left out.
/// That all excess is noise of the pixels is an assumption.
class PixelNoise {
 public:
  explicit PixelNoise(const VisionConfig& config);

  /// Standard deviation of one image coordinate [px].
  [[nodiscard]] double px() const { return scale_ * given_px_; }
  /// TrackObservation::noise_ratio where vision.noise_ratios is true; else 1.
  [[nodiscard]] double Ratio(const TrackObservation& observation) const {
    return ratios_ ? observation.noise_ratio : 1;
  }
  /// px() times the ratio of one observation [px].
  [[nodiscard]] double Of(const TrackObservation& observation) const { return Ratio(observation) * px(); }
  /// Back to what is given.
  void Reset();
  /// A track of the present frame that passed the gate.
  void AddTrack(double nis, int dof);
  /// Ends the frame exposed at `stamp_ns`.
  void EndFrame(TimeNs stamp_ns, bool suspect);

 private:
  double given_px_;
  bool adaptive_;
  bool ratios_;
  double scale_ = 1;
  double mean_ = 1;  ///< of v
  double nis_ = 0;   ///< of the present frame
  int dof_ = 0;
  TimeNs last_ns_ = INT64_MIN;
};

}  // namespace alidade
