#pragma once

#include <string>

#include "tests/support/temporary_folder.h"

namespace alidade::test {

inline constexpr char kImuHeader[] =
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
inline constexpr char kImuRows[] = "1000,0,0,0,0,0,9.81\n2000,0,0,0,0,0,9.81\n3000,0,0,0,0,0,9.81\n";
inline constexpr char kImuYaml[] =
    "sensor_type: imu\nrate_hz: 200\ngyroscope_noise_density: 1e-4\ngyroscope_random_walk: 1e-5\n"
    "accelerometer_noise_density: 2e-3\naccelerometer_random_walk: 3e-3\n";
inline constexpr char kIdentity[] = "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]";
inline constexpr char kTracksHeader[] = "#timestamp [ns],track_id,u [px],v [px]\n";
inline constexpr char kTruthHeader[] = "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n";

inline std::string CameraYaml(const std::string& transform, const std::string& lens) {
  return "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: " + transform +
         "\nresolution: [640, 480]\nintrinsics: [400, 400, 320, 240]\n" + lens;
}

inline const std::string kNoLens = "distortion_model: none\n";

/// Three IMU samples, one track in two frames and two poses of the truth.
inline void WriteGoodSequence(const TemporaryFolder& folder) {
  folder.Write("mav0/imu0/sensor.yaml", kImuYaml);
  folder.Write("mav0/imu0/data.csv", std::string(kImuHeader) + kImuRows);
  folder.Write("mav0/cam0/sensor.yaml", CameraYaml(kIdentity, kNoLens));
  folder.Write("mav0/cam0/tracks.csv", std::string(kTracksHeader) + "1000,1,10,20\n2000,1,11,21\n");
  folder.Write("mav0/state_groundtruth_estimate0/data_pose.csv",
               std::string(kTruthHeader) + "1000,0,0,0,1,0,0,0\n2000,1,0,0,1,0,0,0\n");
}

}  // namespace alidade::test
