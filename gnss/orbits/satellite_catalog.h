#pragma once

#include <optional>

#include "gnss/formats/ephemeris.h"
#include "gnss/formats/precise_products.h"
#include "gnss/formats/signal.h"
#include "gnss/orbits/satellite_state.h"

namespace alidade {

/// Why a satellite has no state.
enum class SatelliteFault { kNone, kNoEphemeris, kUnhealthy };

/// A satellite at one time with what its signals need.
struct SatelliteFix {
  SatelliteFault fault = SatelliteFault::kNone;
  SatelliteState state;
  bool precise = false;                     ///< from SP3 and clocks
  double accuracy_m = 0;                    ///< broadcast URA or SISA; small for precise
  const KeplerEphemeris* kepler = nullptr;  ///< the broadcast message used or, if precise, at hand
  const GlonassEphemeris* glonass = nullptr;
};

/// What a signal of a satellite is late by against the clock that SatelliteFix::state holds.
struct GroupDelay {
  double delay_m = 0;
  double deviation_m = 0;  ///< what is not broadcast and was guessed or left out
};

/// Orbits and clocks of a campaign: broadcast, and precise where products cover the time.
class SatelliteCatalog {
 public:
  explicit SatelliteCatalog(NavigationData navigation, PreciseProducts precise = {});
  SatelliteCatalog(const SatelliteCatalog&) = delete;
  SatelliteCatalog& operator=(const SatelliteCatalog&) = delete;
  virtual ~SatelliteCatalog() = default;

  /// State at transmission of a signal that was received at `tag_ns` of the receiver's clock with this
  /// pseudorange: t = tag - P / c - dt_S, whatever the receiver's clock error (IS-GPS-200 20.3.3.3.3.1).
  ///
  /// Of the ephemerides within the message's age (GPS, QZSS 2 h, Galileo 4 h, BeiDou 6 h, GLONASS 30 min 30
  /// s) the one with the nearest reference time is used, of Galileo I/NAV before F/NAV; of equals the latest.
  /// Its health flag for `signal` applies. A single GLONASS signal (`ionosphere_free` false) whose delay
  /// against the pair of precise clocks is not broadcast keeps to the broadcast orbit and clock: those delays
  /// are metres. Virtual, so that calls can be counted.
  [[nodiscard]] virtual SatelliteFix AtTransmission(SatelliteId satellite, SignalCode signal, TimeNs tag_ns,
                                                    double pseudorange_m, bool ionosphere_free = false) const;

  [[nodiscard]] const NavigationData& navigation() const { return navigation_; }
  [[nodiscard]] bool has_precise() const { return !precise_.orbits.empty(); }
  /// GLONASS frequency channel by ephemeris, if there is one at all.
  [[nodiscard]] std::optional<int> GlonassChannel(int number) const;

 private:
  [[nodiscard]] SatelliteFix Select(SatelliteId satellite, SignalCode signal, TimeNs stamp_ns) const;
  [[nodiscard]] SatelliteState Propagate(const SatelliteFix& fix, TimeNs stamp_ns) const;

  NavigationData navigation_;
  PreciseProducts precise_;
};

/// Group delay of a signal against the clock of `fix`. Broadcast clocks refer to L1/L2 P (GPS, QZSS), E1/E5b
/// (I/NAV), E1/E5a (F/NAV), B3I (BeiDou D1, D2), L1 (GLONASS); precise ones to the ionosphere-free pairs
/// C1W/C2W, E1/E5a, B1I/B3I, L1P/L2P by the IGS convention. Sources: IS-GPS-200 20.3.3.3.3.2, Galileo OS SIS
/// ICD 5.1.5, BDS-SIS-ICD-B1I 5.2.4.10, GLONASS ICD 5.1 table 4.5. BeiDou B1C takes TGD1, as it is near to
/// B1I.
[[nodiscard]] GroupDelay GroupDelayOf(const SatelliteFix& fix, SatelliteId satellite, SignalCode signal);

}  // namespace alidade
