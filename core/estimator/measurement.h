#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/estimator/position_fix_entry.h"
#include "core/sensor.h"

namespace alidade {

/// The sensors whose measurements are functions of the navigation state alone and come between frames. One
/// more of them is one more entry here (such as PositionFixEntry): estimators, runs and their records loop
/// over the entries. Messages of the same time are processed in this order.
using SensorEntries = std::tuple<PositionFixEntry>;

inline constexpr std::size_t kFirstSensorEntry = static_cast<std::size_t>(Sensor::kGnss) + 1;
inline constexpr std::size_t kSensors = kFirstSensorEntry + std::tuple_size_v<SensorEntries>;

/// The sensor of an entry.
template <typename Entry>
[[nodiscard]] constexpr Sensor SensorOf() {
  constexpr std::size_t kIndex = []<std::size_t... Index>(std::index_sequence<Index...>) {
    return ((std::is_same_v<std::tuple_element_t<Index, SensorEntries>, Entry> ? Index : 0) + ...);
  }
  (std::make_index_sequence<std::tuple_size_v<SensorEntries>>());
  static_assert(std::is_same_v<std::tuple_element_t<kIndex, SensorEntries>, Entry>);
  return static_cast<Sensor>(kFirstSensorEntry + kIndex);
}

/// imu | camera | gnss, or the key of the entry.
[[nodiscard]] std::string_view ToString(Sensor sensor);

/// One value a sensor.
template <typename T>
class PerSensor {
 public:
  [[nodiscard]] T& operator[](Sensor sensor) { return values_[static_cast<std::size_t>(sensor)]; }
  [[nodiscard]] const T& operator[](Sensor sensor) const { return values_[static_cast<std::size_t>(sensor)]; }

 private:
  std::array<T, kSensors> values_{};
};

/// Calls visit(entry, sensor) for each entry.
template <typename Visit>
void ForEachSensorEntry(const Visit& visit) {
  std::size_t sensor = kFirstSensorEntry;
  std::apply([&](auto... entry) { (visit(entry, static_cast<Sensor>(sensor++)), ...); }, SensorEntries());
}

template <typename List>
struct MeasurementVariants;
template <typename... Entry>
struct MeasurementVariants<std::tuple<Entry...>> {
  using Raw = std::variant<typename Entry::Raw...>;
  using Whitened = std::variant<typename Entry::Whitened...>;
};
/// A measurement of one of the entries, one alternative an entry. In a log: the sensor's own clock and frame.
/// As an estimator takes it: IMU time, and the world frame W after the alignment.
using Measurement = MeasurementVariants<SensorEntries>::Raw;
/// Its model with its noise, what the back ends use of it. Each alternative has
///
///   static constexpr int kRows;
///   using Residual, Jacobian;                                        kRows x 1, kRows x 15
///   void Evaluate(const NavState&, Residual*, Jacobian*) const;      core/model.h, but whitened
///   void ScaleSqrtInformation(double root);
///
/// and, where it depends on the lever arm of its sensor (p_BA of the sheet),
///
///   Matrix<kRows, 3> LeverArmJacobian(const NavState&) const;        d residual / d p_BA, whitened
using WhitenedMeasurement = MeasurementVariants<SensorEntries>::Whitened;

/// Whether a whitened measurement depends on a lever arm.
template <typename Kind>
concept HasLeverArm = requires(const Kind& measurement, const NavState& state) {
  measurement.LeverArmJacobian(state);
};

template <typename... Kind>
[[nodiscard]] Sensor SensorOf(const std::variant<Kind...>& measurement) {
  return static_cast<Sensor>(kFirstSensorEntry + measurement.index());
}
[[nodiscard]] TimeNs StampOf(const Measurement& measurement);
/// For messages: "position fix"; "position fixes". Precondition: the sensor has an entry.
[[nodiscard]] const char* NameOf(Sensor sensor);
[[nodiscard]] const char* PluralNameOf(Sensor sensor);

/// The measurement with the noise that the configuration assumes. kInput: it is none, or its sensor is not
/// one of the rig's.
[[nodiscard]] Result<WhitenedMeasurement> Whiten(const EstimatorConfig& config, const RigCalibration& rig,
                                                 const Measurement& measurement);
/// The sensor whose lever arm is tested along with a watched camera (core/calibration_watch.h): the GNSS
/// receiver, else the first of SensorEntries that has a lever arm and one sheet in `rig`, where the
/// configuration uses them.
[[nodiscard]] std::optional<Sensor> AntennaToWatch(const EstimatorConfig& config, const RigCalibration& rig);
/// The keys of the entries, joined by '_': for one number about the measurements of all of them.
[[nodiscard]] const std::string& MeasurementKeys();
/// How long after a frame a smoother links a measurement of this sensor to it [s].
[[nodiscard]] double MaxInterpolation(const EstimatorConfig& config, Sensor sensor);

/// The gates of all entries.
class MeasurementGates {
 public:
  explicit MeasurementGates(const EstimatorConfig& config);

  /// See MeasurementGate.
  double Weigh(Sensor sensor, double nis);
  void Reset();

 private:
  std::vector<MeasurementGate> gates_;
};

}  // namespace alidade
