#pragma once

#include <string>

#include "core/random.h"
#include "eval/simulation/sim_gnss_config.h"

namespace alidade {

/// The clock of a simulated receiver: bias and drift walk as in gnss/model/receiver_clock.h, and the bias may
/// jump by a millisecond once.
class SimReceiverClock {
 public:
  /// `config` must outlive the clock.
  SimReceiverClock(const SimGnssConfig& config, std::uint64_t seed);

  /// To `time_s` of the sequence, `dt_s` after the last time.
  void Advance(double dt_s, double time_s);
  [[nodiscard]] double bias_m() const { return bias_m_; }
  [[nodiscard]] double drift_mps() const { return drift_mps_; }

 private:
  const SimGnssConfig& config_;
  RandomStream stream_;
  double bias_m_ = 0;
  double drift_mps_ = 0;
  bool jumped_ = false;
};

/// What the signals of one satellite suffer from around a simulated receiver: correlated multipath
/// (first-order Gauss-Markov) and reflections, which come and go.
class SimSignalPath {
 public:
  /// `config` must outlive the path; `name` of the satellite names its random streams.
  SimSignalPath(const SimGnssConfig& config, std::uint64_t seed, const std::string& name);

  void Advance(double dt_s);
  [[nodiscard]] double delay_m() const { return multipath_m_ + reflection_m_; }
  /// The next draw of a unit normal, for the noise of a measurement.
  double Noise() { return noise_.Normal(); }

 private:
  void DrawReflection();

  const SimGnssConfig& config_;
  RandomStream noise_;
  RandomStream multipath_;
  RandomStream nlos_;
  double multipath_m_ = 0;
  double reflection_m_ = 0;
};

}  // namespace alidade
