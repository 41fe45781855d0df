#include "core/estimator/measurement.h"

namespace alidade {

std::string_view ToString(Sensor sensor) {
  constexpr std::array<std::string_view, kFirstSensorEntry> kNames = {"imu", "camera", "gnss"};
  if (static_cast<std::size_t>(sensor) < kFirstSensorEntry) {
    return kNames[static_cast<std::size_t>(sensor)];
  }
  std::string_view key;
  ForEachSensorEntry([&](auto entry, Sensor of) { key = of == sensor ? entry.kKey : key; });
  return key;
}

TimeNs StampOf(const Measurement& measurement) {
  return std::visit([](const auto& raw) { return raw.stamp_ns; }, measurement);
}

const char* NameOf(Sensor sensor) {
  const char* name = "";
  ForEachSensorEntry([&](auto entry, Sensor of) { name = of == sensor ? entry.kName : name; });
  return name;
}

const char* PluralNameOf(Sensor sensor) {
  const char* name = "";
  ForEachSensorEntry([&](auto entry, Sensor of) { name = of == sensor ? entry.kPluralName : name; });
  return name;
}

Result<WhitenedMeasurement> Whiten(const EstimatorConfig& config, const RigCalibration& rig,
                                   const Measurement& measurement) {
  WhitenedMeasurement whitened;
  Status status;
  ForEachSensorEntry([&](auto entry, Sensor) {
    if (const auto* raw = std::get_if<typename decltype(entry)::Raw>(&measurement)) {
      const auto made = entry.Whiten(config, rig, *raw);
      status = made.status();
      if (made.ok()) {
        whitened = *made;
      }
    }
  });
  return status.ok() ? Result<WhitenedMeasurement>(whitened) : status;
}

std::optional<Sensor> AntennaToWatch(const EstimatorConfig& config, const RigCalibration& rig) {
  if (config.gnss.enabled && rig.gnss.is_present) {
    return Sensor::kGnss;
  }
  std::optional<Sensor> antenna;
  ForEachSensorEntry([&](auto entry, Sensor sensor) {
    if constexpr (HasLeverArm<typename decltype(entry)::Whitened>) {
      if (!antenna && entry.Config(config).enabled && entry.Sensors(rig).size() == 1) {
        antenna = sensor;
      }
    }
  });
  return antenna;
}

const std::string& MeasurementKeys() {
  static const std::string keys = [] {
    std::string joined;
    ForEachSensorEntry(
        [&](auto entry, Sensor) { joined += (joined.empty() ? "" : "_") + std::string(entry.kKey); });
    return joined;
  }();
  return keys;
}

double MaxInterpolation(const EstimatorConfig& config, Sensor sensor) {
  double max_s = 0;
  ForEachSensorEntry([&](auto entry, Sensor of) {
    max_s = of == sensor ? entry.Config(config).max_interpolation_s : max_s;
  });
  return max_s;
}

MeasurementGates::MeasurementGates(const EstimatorConfig& config) {
  ForEachSensorEntry([&](auto entry, Sensor) { gates_.push_back(entry.MakeGate(config)); });
}

double MeasurementGates::Weigh(Sensor sensor, double nis) {
  return gates_[static_cast<std::size_t>(sensor) - kFirstSensorEntry].Weigh(nis);
}

void MeasurementGates::Reset() {
  for (MeasurementGate& gate : gates_) {
    gate.Reset();
  }
}

}  // namespace alidade
