#pragma once

#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>

namespace alidade {

/// Which frames the solver of GVINS gets, and with which GNSS epoch: every second frame, those that are
/// nearer to the epochs (decided once, by two frames after the first epoch), each with an epoch within 0.05
/// s. While no epoch waits, no frame goes on. Without GNSS: every second frame, at once. Times [s] in one
/// clock.
class GvinsPairing {
 public:
  struct Pair {
    std::size_t frame = 0;
    std::optional<std::size_t> epoch;
  };

  explicit GvinsPairing(bool gnss) : gnss_(gnss), taken_parity_(gnss ? -1 : 1) {}

  void AddEpoch(double time_s, std::size_t epoch) {
    if (gnss_) {
      latest_epoch_s_ = time_s;
      epochs_.push_back({time_s, epoch});
    }
  }

  /// Whether the frame is taken.
  bool AddFrame(double time_s, std::size_t frame) {
    ++frames_seen_;
    if (taken_parity_ < 0) {
      if (latest_epoch_s_ && last_frame_s_) {
        const bool worse = std::abs(time_s - *latest_epoch_s_) > std::abs(*last_frame_s_ - *latest_epoch_s_);
        taken_parity_ = worse ? 1 - frames_seen_ % 2 : frames_seen_ % 2;
      }
      last_frame_s_ = time_s;
    }
    const bool taken = taken_parity_ == frames_seen_ % 2;
    if (taken) {
      frames_.push_back({time_s, frame});
    }
    return taken;
  }

  /// The next frame that can go on.
  std::optional<Pair> Next() {
    if (frames_.empty()) {
      return std::nullopt;
    }
    Pair pair{frames_.front().index, std::nullopt};
    if (gnss_) {
      const double frame_s = frames_.front().time_s;
      while (!epochs_.empty() && epochs_.front().time_s < frame_s - kNearS) {
        epochs_.pop_front();
      }
      if (epochs_.empty()) {
        return std::nullopt;
      }
      if (std::abs(epochs_.front().time_s - frame_s) < kNearS) {
        pair.epoch = epochs_.front().index;
        epochs_.pop_front();
      }
    }
    frames_.pop_front();
    return pair;
  }

 private:
  static constexpr double kNearS = 0.05;
  struct Item {
    double time_s;
    std::size_t index;
  };

  bool gnss_;
  int taken_parity_;  ///< of the count of frames; negative: not decided
  int frames_seen_ = 0;
  std::optional<double> latest_epoch_s_, last_frame_s_;
  std::deque<Item> frames_, epochs_;
};

}  // namespace alidade
