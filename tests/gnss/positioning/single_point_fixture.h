#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_options.h"
#include "tests/gnss/model/synthetic_sky.h"

namespace alidade::test {

inline constexpr TimeNs kStamp = 1'593'043'200 * kSecondNs;

inline GnssCorrectionOptions NoIonosphere() {
  GnssCorrectionOptions options;
  options.ionosphere = IonosphereMode::kNone;
  return options;
}

inline SinglePointSolver MakeSolver(const NavigationData& sky,
                                    std::optional<Eigen::Vector3d> start = std::nullopt,
                                    GnssCorrectionOptions options = NoIonosphere()) {
  return {MeasurementBuilder(std::make_shared<SatelliteCatalog>(sky), std::move(options)),
          SinglePointOptions(), std::move(start)};
}

inline SyntheticReceiver Receiver() {
  SyntheticReceiver receiver;
  receiver.stamp_ns = kStamp;
  receiver.velocity_E = {3, -8, 1};
  receiver.clock_m = -271'828.18;
  receiver.drift_mps = 31.4;
  receiver.galileo_bias_m = 6.5;
  return receiver;
}

/// Keeps so many satellites of GPS and Galileo above 15 deg, spread in azimuth.
inline ObservationEpoch Thin(const NavigationData& sky, const SyntheticReceiver& receiver, std::size_t gps,
                             std::size_t galileo) {
  ObservationEpoch epoch = Observe(sky, receiver);
  const EnuFrame frame = EnuFrame::At(receiver.position_E);
  std::map<GnssSystem, std::map<double, SatelliteId>> by_azimuth;
  for (const SatelliteObservation& s : epoch.satellites) {
    const SatelliteState state = PropagateKepler(sky.kepler.at(s.satellite)[0], receiver.stamp_ns);
    const Direction direction = DirectionTo(frame, state.position_E);
    if (direction.elevation_rad > 15 * M_PI / 180) {
      by_azimuth[s.satellite.system][direction.azimuth_rad] = s.satellite;
    }
  }
  std::set<SatelliteId> kept;
  for (const auto& [system, satellites] : by_azimuth) {
    const std::size_t count = system == GnssSystem::kGps ? gps : galileo;
    for (std::size_t i = 0; i < count; ++i) {
      kept.insert(
          std::next(satellites.begin(), static_cast<std::ptrdiff_t>(i * satellites.size() / count))->second);
    }
  }
  std::erase_if(epoch.satellites, [&](const SatelliteObservation& s) { return !kept.contains(s.satellite); });
  return epoch;
}

}  // namespace alidade::test
