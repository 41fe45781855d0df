#include "eval/dataset/digest.h"

#include <bit>
#include <cstdint>
#include <string>

#include "eval/files/sha256.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

/// Collects numbers as little-endian 64-bit words, whatever the machine, and hashes them in blocks.
class Hasher {
 public:
  Hasher() { block_.reserve(kBlock); }

  void Add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) {
      block_.push_back(static_cast<char>(static_cast<unsigned char>(word >> shift)));
    }
    if (block_.size() >= kBlock) {
      Flush();
    }
  }
  void Add(std::int64_t number) { Add(static_cast<std::uint64_t>(number)); }
  void Add(double number) { Add(std::bit_cast<std::uint64_t>(number + 0.0)); }  // -0 counts as 0
  template <typename Derived>
  void Add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index col = 0; col < matrix.cols(); ++col) {
        Add(static_cast<double>(matrix(row, col)));
      }
    }
  }

  std::string Hex() {
    Flush();
    return hash_.Hex();
  }

 private:
  static constexpr size_t kBlock = 1 << 16;

  void Flush() {
    hash_.Add(block_);
    block_.clear();
  }

  Sha256 hash_;
  std::string block_;
};

void AddCamera(const CameraModel& camera, const Pose& T_BC, Hasher* hasher) {
  hasher->Add(static_cast<std::int64_t>(camera.model()));
  hasher->Add(std::int64_t{camera.width_px()});
  hasher->Add(std::int64_t{camera.height_px()});
  hasher->Add(camera.intrinsics());
  hasher->Add(Eigen::Vector4d(camera.coefficients().head<4>()));
  if (camera.model() == DistortionModel::kMei) {
    hasher->Add(camera.coefficients()[4]);
  }
  hasher->Add(T_BC.rotation);
  hasher->Add(T_BC.translation);
}

void AddRig(const RigCalibration& rig, Hasher* hasher) {
  AddCamera(rig.camera, rig.T_BC, hasher);
  hasher->Add(rig.imu_noise.gyro_noise_density_radps_sqrthz);
  hasher->Add(rig.imu_noise.accel_noise_density_mps2_sqrthz);
  hasher->Add(rig.imu_noise.gyro_random_walk_radps2_sqrthz);
  hasher->Add(rig.imu_noise.accel_random_walk_mps3_sqrthz);
  hasher->Add(rig.camera_time_offset_s);
}

/// Counts before lists: without them a sample could move between lists and leave the bytes unchanged.
void AddFrames(const std::vector<TrackFrame>& frames, Hasher* hasher) {
  hasher->Add(static_cast<std::uint64_t>(frames.size()));
  for (const TrackFrame& frame : frames) {
    hasher->Add(std::int64_t{frame.stamp_ns});
    hasher->Add(static_cast<std::uint64_t>(frame.observations.size()));
    for (const TrackObservation& observation : frame.observations) {
      hasher->Add(observation.track_id);
      hasher->Add(observation.pixel);
    }
  }
}

void AddSatellite(SatelliteId id, Hasher* hasher) {
  hasher->Add(static_cast<std::int64_t>(id.system));
  hasher->Add(std::int64_t{id.number});
}

void AddValue(const std::optional<double>& value, Hasher* hasher) {
  hasher->Add(std::int64_t{value.has_value()});
  hasher->Add(value.value_or(0));
}

void AddEphemeris(const KeplerEphemeris& e, Hasher* hasher) {
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

void AddEphemeris(const GlonassEphemeris& e, Hasher* hasher) {
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

/// Observations and broadcast ephemerides; precise products are not part of it.
void AddGnss(const GnssReceiver& receiver, const GnssLog& gnss, Hasher* hasher) {
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
}

/// Nothing for a log without fixes.
void AddFixes(const MeasurementLog& log, Hasher* hasher) {
  if (log.fixes.empty()) {
    return;
  }
  for (const FixSensor& sensor : log.rig.fixes) {
    hasher->Add(sensor.p_BA);
    hasher->Add(sensor.time_offset_s);
    hasher->Add(std::int64_t{sensor.anchor_llh_deg.has_value()});
    hasher->Add(sensor.anchor_llh_deg.value_or(Eigen::Vector3d::Zero()));
  }
  for (const PositionFix& fix : log.fixes) {
    hasher->Add(std::int64_t{fix.stamp_ns});
    hasher->Add(std::int64_t{fix.sensor});
    hasher->Add(fix.p_A);
    hasher->Add(fix.covariance);
  }
}

}  // namespace

std::string DigestOf(const MeasurementLog& log) {
  Hasher hasher;
  AddRig(log.rig, &hasher);
  hasher.Add(static_cast<std::uint64_t>(log.imu.size()));
  for (const ImuSample& sample : log.imu) {
    hasher.Add(std::int64_t{sample.stamp_ns});
    hasher.Add(sample.gyro);
    hasher.Add(sample.accel);
  }
  AddFrames(log.frames, &hasher);
  for (const ExtraCamera& extra : log.extra_cameras) {
    AddCamera(extra.camera, extra.T_BC, &hasher);
    hasher.Add(extra.camera_time_offset_s);
    AddFrames(extra.frames, &hasher);
  }
  if (log.gnss != nullptr) {
    AddGnss(log.rig.gnss, *log.gnss, &hasher);
  }
  AddFixes(log, &hasher);
  return hasher.Hex();
}

}  // namespace alidade
