#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/random.h"
#include "eval/dataset/dataset.h"
#include "eval/simulation/fault_span.h"
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

/// How far the measured position of GNSS and position fixes is pulled off the truth, as by a spoofer: at
/// fault_ramp_mps in a horizontal direction that the seed draws, from fault_start_s on for fault_duration_s,
/// and from then on it stays.
class SimPull {
 public:
  SimPull(const SimulatorConfig& config, std::uint64_t seed);

  /// [m], in the world frame; `time_s` of the sequence.
  [[nodiscard]] Eigen::Vector3d At(double time_s) const;
  /// Whether range rates are those of the pulled antenna.
  [[nodiscard]] bool moves_rates() const { return moves_rates_; }

 private:
  double start_s_;
  double duration_s_;
  bool pulls_;
  bool moves_rates_;
  Eigen::Vector3d velocity_W_mps_;
};

/// Applies the fault SimulatorConfig::fault, over [fault_start_s, fault_start_s + fault_duration_s) from
/// `start_ns` on. blackout: frames are empty; a track that comes back afterwards has a new id. tracks: a
/// frame's ids are shuffled, anew in every frame. frozen: frames show what the first one of the fault showed.
/// frame_drops: each frame is missing with probability fault_drop_rate. camera_clock: stamps of the first
/// camera's frames have fault_clock_jump_s more from the start of the fault on. Faults of the IMU:
/// eval/simulation/sim_imu_fault.h; of rendered images: eval/render/image_fault.h; of GNSS: SimPull, and
/// AddSimulatedGnss for stale ephemerides.
void ApplyFault(const SimulatorConfig& config, std::uint64_t seed, TimeNs start_ns, Dataset* dataset);

}  // namespace alidade
