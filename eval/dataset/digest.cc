#include "eval/dataset/digest.h"

#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_parts.h"
#include "eval/dataset/log_hasher.h"
#include "eval/dataset/log_tables.h"

namespace alidade {
namespace {

/// The calibration of IMU and first camera, of which every log has one.
void AddRig(const RigCalibration& rig, LogHasher* hasher) {
  DigestCamera(rig.camera, rig.T_BC, hasher);
  hasher->Add(rig.imu_noise.gyro_noise_density_radps_sqrthz);
  hasher->Add(rig.imu_noise.accel_noise_density_mps2_sqrthz);
  hasher->Add(rig.imu_noise.gyro_random_walk_radps2_sqrthz);
  hasher->Add(rig.imu_noise.accel_random_walk_mps3_sqrthz);
  hasher->Add(rig.camera_time_offset_s);
  if (rig.line_delay_s != 0) {
    hasher->Add(rig.line_delay_s);
  }
}

}  // namespace

std::string DigestOf(const MeasurementLog& log) {
  return DigestOf(log, TablesOf(log)).value();  // tables in memory have no errors
}

Result<std::string> DigestOf(const MeasurementLog& log, const LogTables& tables) {
  LogHasher hasher;
  AddRig(log.rig, &hasher);
  for (const DatasetPart& part : DatasetParts()) {
    if (part.digest != nullptr) {
      ALIDADE_RETURN_IF_ERROR(part.digest(log, tables, &hasher));
    }
  }
  return hasher.Hex();
}

}  // namespace alidade
