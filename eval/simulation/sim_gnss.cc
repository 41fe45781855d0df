#include "eval/simulation/sim_gnss.h"

#include <memory>

#include "eval/simulation/sim_constellation.h"
#include "eval/simulation/sim_fault.h"
#include "eval/simulation/sim_receiver.h"
#include "gnss/formats/rinex_navigation.h"

namespace alidade {

Status AddSimulatedGnss(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                        TimeNs start_ns, std::uint64_t seed, Dataset* dataset) {
  const SimGnssConfig& gnss = config.gnss;
  if (gnss.rate_hz == 0) {
    return Status::Ok();
  }
  const TimeNs end_ns = start_ns + SecondsToNs(trajectory.DurationSeconds());
  const auto simulated = [&](TimeNs age_ns) {
    return std::make_shared<const SatelliteCatalog>(
        SimulateConstellations(gnss.systems, start_ns - age_ns, end_ns - age_ns));
  };
  std::shared_ptr<const SatelliteCatalog> catalog;
  if (gnss.navigation_file == kNoPath) {
    catalog = simulated(0);
  } else {
    Result<NavigationData> read = ReadRinexNavigation(gnss.navigation_file);
    ALIDADE_RETURN_IF_ERROR(read.status());
    catalog = std::make_shared<const SatelliteCatalog>(*std::move(read));
  }
  SimReceiver receiver(gnss, trajectory, start_ns, SimPull(config, seed), seed, catalog);
  auto log = std::make_shared<GnssLog>();
  log->epochs = receiver.Run();
  // An epoch without satellites is none.
  std::erase_if(log->epochs, [](const ObservationEpoch& epoch) { return epoch.satellites.empty(); });
  if (log->epochs.empty()) {
    return Status::Input(
        "gnss.navigation_file: found no satellite above the mask during the sequence, "
        "expected ephemerides of its time (start_time_s)");
  }
  log->glonass_channels = receiver.channels();
  log->catalog = config.fault == SimFaultKind::kStaleEphemerides ? simulated(kDayNs) : catalog;
  log->approximate_position_E = receiver.enu().origin_E;
  dataset->gnss = std::move(log);
  dataset->rig.gnss = {gnss.lever_arm_m, gnss.time_offset_s, receiver.enu().origin_E, true};
  return Status::Ok();
}

}  // namespace alidade
