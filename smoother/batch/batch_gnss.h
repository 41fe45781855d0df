#pragma once

#include <vector>

#include "smoother/sliding/gnss_window.h"

namespace alidade {

/// The GNSS epochs of a whole sequence and the clocks of its frames, for the batch estimate. Epochs are
/// attached to frames as in the sliding window (GnssWindow); the clocks are linear, so that their initial
/// values need to be good enough to find jumps only.
class BatchGnss {
 public:
  BatchGnss(const GnssConfig& config, const GnssReceiver& receiver, const Eigen::Vector3d& gravity_W)
      : window_(config, receiver, gravity_W) {}

  void Clear();
  /// Null before Align.
  [[nodiscard]] const GnssFactorContext* context() const { return window_.context(); }

  /// Gives all frames so far a clock, and `prior` the columns of the first one's.
  void Align(const GnssAlignment& alignment, const WindowFrames& frames, LinearPrior* prior);
  /// The clock of the last of `frames`, which was just added.
  void AddFrame(const WindowFrames& frames);
  /// Hangs an epoch on the newest frame; `imu` leads there from the frame, empty at the frame itself. An
  /// epoch at which the clock was lost is left out.
  void AddEpoch(const GnssEpoch& epoch, std::vector<ImuSample> imu, const ImuNoise& noise,
                WindowFrame* frame);

  /// Puts the epochs on their frames, linked at the present biases; with `gate` their rows are gated at the
  /// present states. True when the verdict on a row has changed.
  bool Select(bool gate, const ImuNoise& noise, const WindowFrames& frames);
  /// The satellites that the last Select with a gate used and refused at a frame.
  void Count(int frame, FrameStatistics* statistics) const;

 private:
  struct Epoch {
    FrameEpoch attached;     ///< with its own noise
    int frame = 0;           ///< index of the frame that it is attached to
    std::vector<bool> used;  ///< by row, of the last gate
  };

  GnssWindow window_;
  std::vector<Epoch> epochs_;                ///< in order of time
  std::vector<FrameStatistics> statistics_;  ///< by frame, of the last gate
};

}  // namespace alidade
