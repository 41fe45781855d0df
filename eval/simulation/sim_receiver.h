#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/sim_fault.h"
#include "eval/simulation/sim_gnss_config.h"
#include "eval/simulation/sim_signal_path.h"
#include "gnss/base/geodesy.h"
#include "gnss/formats/observation.h"
#include "gnss/orbits/satellite_catalog.h"

namespace alidade {

/// One run of a simulated GNSS receiver over a trajectory: what AddSimulatedGnss describes, up to the
/// observations.
class SimReceiver {
 public:
  /// `config` and `trajectory` must outlive the object; `start_ns`: IMU time of the trajectory's time 0.
  SimReceiver(const SimGnssConfig& config, const ContinuousTrajectory& trajectory, TimeNs start_ns,
              const SimPull& pull, std::uint64_t seed, std::shared_ptr<const SatelliteCatalog> catalog);

  std::vector<ObservationEpoch> Run();

  [[nodiscard]] const std::map<int, int>& channels() const { return channels_; }
  [[nodiscard]] const EnuFrame& enu() const { return enu_; }

 private:
  struct Sight {
    SatelliteFix fix;
    Direction direction;
    double range_m = 0;  ///< with both clocks and the satellite's delays, noise-free
  };

  /// Where the antenna seems to be.
  [[nodiscard]] Eigen::Vector3d AntennaAt(double time_s, const Eigen::Vector3d& pull_W) const;
  [[nodiscard]] std::optional<int> Channel(SatelliteId id) const;
  /// A signal's path to an antenna that stands at `antenna_E` at the true time tag - clock. The flight is
  /// found by iteration, without the series in omega / c that the models use.
  [[nodiscard]] std::optional<Sight> Look(SatelliteId id, SignalCode signal, TimeNs tag_ns, double clock_m,
                                          const Eigen::Vector3d& antenna_E) const;
  ObservationEpoch Observe(TimeNs tag_ns);
  /// Draws its noise whether the satellite is seen or not.
  std::optional<SignalObservation> Measure(SatelliteId id, SignalCode signal, TimeNs tag_ns, double time_s,
                                           double* elevation);

  const SimGnssConfig& config_;
  SimPull pull_;
  const ContinuousTrajectory& trajectory_;
  TimeNs start_gpst_ns_;
  std::shared_ptr<const SatelliteCatalog> catalog_;
  SimReceiverClock clock_;
  EnuFrame enu_;
  std::map<GnssSystem, double> system_bias_m_;
  double ionosphere_scale_ = 1;
  std::vector<SatelliteId> satellites_;
  std::map<int, int> channels_;
  std::map<SatelliteId, SimSignalPath> paths_;
};

}  // namespace alidade
