#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/random.h"
#include "eval/dataset/dataset.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// What is wrong with one track, from `onset` frames after its first on.
struct TrackFault {
  bool wrong = false;
  SimOutlierKind kind = SimOutlierKind::kJump;  ///< never kMixed
  /// Jump and swap befall a track that was right at first: the case that a gate can catch. Others start with
  /// the track. A track that ends earlier stays right.
  int onset = 0;
  Eigen::Vector2d jump_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d drift_px_per_s = Eigen::Vector2d::Zero();
  Eigen::Vector3d velocity_W_mps = Eigen::Vector3d::Zero();  ///< horizontal
};

/// Draws faults. Each has a stream of its own, named by landmark and frame: a fault moves no other number,
/// and no other effect moves it.
class FaultSource {
 public:
  /// `camera` names the streams. Keeps a reference to the configuration.
  FaultSource(const SimulatorConfig& config, std::uint64_t seed, std::string camera)
      : config_(config), seed_(seed), camera_(std::move(camera)) {}

  /// Of a track that starts on this landmark in this frame: wrong with probability outlier_rate when outliers
  /// are tracks, else never.
  [[nodiscard]] TrackFault OfTrack(int landmark, int frame) const;
  /// Whether this one observation is wrong: never when outliers are tracks.
  [[nodiscard]] bool OfObservation(int landmark, int frame) const;
  /// Random direction, size outlier_px times 0.5 to 1.5.
  [[nodiscard]] Eigen::Vector2d Jump(int landmark, int frame) const;
  /// Anywhere in the image.
  [[nodiscard]] Eigen::Vector2d AnyPixel(int landmark, int frame, int width_px, int height_px) const;

 private:
  [[nodiscard]] RandomStream Stream(const char* purpose, int landmark, int frame) const;
  Eigen::Vector2d DrawVector(RandomStream* stream) const;

  const SimulatorConfig& config_;
  std::uint64_t seed_;
  std::string camera_;
};

/// Applies the fault SimulatorConfig::fault, over [fault_start_s, fault_start_s + fault_duration_s) from
/// `start_ns` on. blackout: frames are empty; a track that comes back afterwards has a new id. imu: rates and
/// specific forces are uniform in +-3 rad/s and +-30 m/s^2. tracks: a frame's ids are shuffled, anew in every
/// frame. frozen: frames show what the first one of the fault showed. imu_gap: no samples. gyro_spike,
/// accel_spike: 30 rad/s or 490 m/s^2 (50 g) in a random direction are added to one sample, drawn from those
/// of the fault.
void ApplyFault(const SimulatorConfig& config, std::uint64_t seed, TimeNs start_ns, Dataset* dataset);

}  // namespace alidade
