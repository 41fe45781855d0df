#pragma once

#include <string>

#include "core/config_schema.h"
#include "core/robust_kernel.h"
#include "core/status.h"

namespace alidade {

/// Ionosphere correction: none, the broadcast model (Klobuchar with GPS parameters, else BeiDou's, else none
/// with a larger standard deviation; NeQuick G is not implemented), or the ionosphere-free pair of two bands,
/// for which a satellite without a second band is not used.
enum class IonosphereMode { kNone, kBroadcast, kFree };

/// Which signals are used and how far they are trusted.
struct GnssCorrectionOptions {
  std::string systems = "GECJR";  ///< RINEX letters
  IonosphereMode ionosphere = IonosphereMode::kBroadcast;
  double elevation_mask_deg = 10;
  double min_cn0_dbhz = 15;
  double pseudorange_std_m = 0.7;
  double range_rate_std_mps = 0.05;
  double glonass_factor = 2;
  double model_std_scale = 1;

  void Describe(ConfigVisitor& visitor);
  /// kConfig: an unknown system.
  [[nodiscard]] Status Validate() const;
};

/// Raw GNSS in an estimator: signals and weights, gate and kernel, receiver clock, alignment. Shared by both
/// back ends.
struct GnssConfig {
  bool enabled = false;
  GnssCorrectionOptions corrections;
  bool pseudorange = true;
  bool doppler = true;
  double gate_probability = 0.999;
  double max_gated_share = 0.5;
  RobustKernel robust_kernel = RobustKernel::kHuber;
  double robust_scale_sigma = 2.0;
  bool lasting_errors = true;
  // Receiver clock (gnss/model/receiver_clock.h).
  double clock_walk_m_sqrts = 0.1;
  double drift_walk_mps_sqrts = 0.1;
  double inter_system_walk_m_sqrts = 0.01;
  double inter_system_std_m = 30;
  double clock_jump_m = 300;
  // Alignment (gnss/alignment/alignment.h).
  int align_min_epochs = 6;
  int align_min_satellites = 1;
  double align_window_s = 30;
  double align_max_yaw_std_rad = 0.05;
  double align_inflation = 2;
  bool estimate_time_offset = false;
  double max_time_offset_s = 0.2;
  // Smoother.
  double max_interpolation_s = 0.3;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
