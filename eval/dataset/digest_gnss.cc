#include <cstdint>
#include <optional>

#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/log_hasher.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

void AddSatellite(SatelliteId id, LogHasher* hasher) {
  hasher->Add(static_cast<std::int64_t>(id.system));
  hasher->Add(std::int64_t{id.number});
}

void AddValue(const std::optional<double>& value, LogHasher* hasher) {
  hasher->Add(std::int64_t{value.has_value()});
  hasher->Add(value.value_or(0));
}

void AddEphemeris(const KeplerEphemeris& e, LogHasher* hasher) {
  AddSatellite(e.satellite, hasher);
  hasher->Add(static_cast<std::int64_t>(e.message));
  for (const std::int64_t number : {e.toc_ns, e.toe_ns, std::int64_t{e.health}, std::int64_t{e.issue}}) {
    hasher->Add(number);
  }
  for (const double number : {e.af0,
                              e.af1,
                              e.af2,
                              e.sqrt_a,
                              e.eccentricity,
                              e.i0,
                              e.omega0,
                              e.omega,
                              e.m0,
                              e.delta_n,
                              e.omega_dot,
                              e.i_dot,
                              e.cuc,
                              e.cus,
                              e.crc,
                              e.crs,
                              e.cic,
                              e.cis,
                              e.accuracy_m,
                              e.group_delay_s[0],
                              e.group_delay_s[1],
                              e.toe_of_week_s}) {
    hasher->Add(number);
  }
}

void AddEphemeris(const GlonassEphemeris& e, LogHasher* hasher) {
  AddSatellite(e.satellite, hasher);
  hasher->Add(std::int64_t{e.toe_ns});
  hasher->Add(std::int64_t{e.health});
  hasher->Add(std::int64_t{e.channel});
  hasher->Add(e.clock_bias_s);
  hasher->Add(e.clock_drift);
  hasher->Add(e.position_m);
  hasher->Add(e.velocity_mps);
  hasher->Add(e.acceleration_mps2);
}

}  // namespace

Status DigestGnss(const MeasurementLog& log, const LogTables& /*tables*/, LogHasher* hasher) {
  if (log.gnss == nullptr) {
    return Status::Ok();
  }
  const GnssReceiver& receiver = log.rig.gnss;
  const GnssLog& gnss = *log.gnss;
  hasher->Add(receiver.p_BA);
  hasher->Add(receiver.time_offset_s);
  hasher->Add(receiver.anchor_E.value_or(Eigen::Vector3d::Zero()));
  hasher->Add(static_cast<std::uint64_t>(gnss.epochs.size()));
  for (const ObservationEpoch& epoch : gnss.epochs) {
    hasher->Add(std::int64_t{epoch.stamp_ns});
    hasher->Add(static_cast<std::uint64_t>(epoch.satellites.size()));
    for (const SatelliteObservation& observed : epoch.satellites) {
      AddSatellite(observed.satellite, hasher);
      hasher->Add(static_cast<std::uint64_t>(observed.signals.size()));
      for (const SignalObservation& signal : observed.signals) {
        hasher->Add(std::int64_t{signal.signal.band});
        hasher->Add(std::int64_t{signal.signal.attribute});
        for (const auto& value : {signal.pseudorange_m, signal.doppler_hz, signal.cn0_dbhz}) {
          AddValue(value, hasher);
        }
      }
    }
  }
  for (const auto& [id, list] : gnss.catalog->navigation().kepler) {
    for (const KeplerEphemeris& ephemeris : list) {
      AddEphemeris(ephemeris, hasher);
    }
  }
  for (const auto& [number, list] : gnss.catalog->navigation().glonass) {
    for (const GlonassEphemeris& ephemeris : list) {
      AddEphemeris(ephemeris, hasher);
    }
  }
  return Status::Ok();
}

}  // namespace alidade
