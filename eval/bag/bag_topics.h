#pragma once

#include <map>
#include <string>

#include "core/status.h"

namespace alidade {

/// Names of topics. When reading, a topic with an empty name is found by its type, which must be unique.
struct BagTopics {
  std::string imu = "/imu0";
  std::string camera = "/cam0/image_raw";
  std::string tracks = "/cam0/tracks";
  std::string truth = "/ground_truth";
  std::string range = "/ublox_driver/range_meas";
  std::string ephemeris = "/ublox_driver/ephem";
  std::string glonass_ephemeris = "/ublox_driver/glo_ephem";
  std::string ionosphere = "/ublox_driver/iono_params";
  std::string beidou_ionosphere = "/ublox_driver/iono_params_bds";
  std::string solution = "/ublox_driver/receiver_pvt";
  std::string time_pulse = "/ublox_driver/time_pulse_info";
  std::string trigger = "/external_trigger";
  std::string fix = "/fix0/fix";  ///< sensor_msgs/NavSatFix of fix0; it is not searched for by type

  /// Sets "imu=/imu/data,cam0=/left/image_raw": imu, cam0, tracks, truth, range, ephem, glo_ephem, iono, pvt,
  /// pulse, trigger, fix. kUsage: an unknown sensor, or no name.
  Status Set(const std::string& list);

  /// Replaces a name that a bag does not have by that of the only topic of its types, or by nothing when
  /// there is none. `found`: topic -> type. kInput: no IMU, a name that was set but does not exist, an
  /// ambiguous topic.
  Status Resolve(const std::string& path, const std::map<std::string, std::string>& found);
};

/// The sensor.yaml of a sensor ("imu0", "cam0", "gnss0", "cam1") as text in a bag.
[[nodiscard]] inline std::string SheetTopic(const std::string& sensor) {
  return "/" + sensor + "/sensor_yaml";
}

}  // namespace alidade
