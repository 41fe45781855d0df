#include "eval/dataset/dataset_parts.h"

#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_check_imu.h"
#include "eval/dataset/dataset_check_rig.h"
#include "eval/dataset/dataset_fix.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/dataset_imu.h"
#include "eval/dataset/dataset_truth.h"

namespace alidade {

const std::vector<DatasetPart>& DatasetParts() {
  static const std::vector<DatasetPart> parts = {
      {ReadImuFolder, WriteImuFolder, DigestImu, CheckImu},
      // Findings alone: the calibrations are read, written and digested with their sensors.
      {nullptr, nullptr, nullptr, CheckRig},
      {ReadCameraFolders, WriteCameraFolders, DigestTracks, CheckCamera},
      {ReadGnssFolder, WriteGnssFolder, DigestGnss, CheckGnss},
      {ReadFixFolders, WriteFixFolders, DigestFixes, CheckFixes},
      // Findings alone: the further cameras are read, written and digested with the first one.
      {nullptr, nullptr, nullptr, CheckExtraCameras},
      {ReadTruthFolder, WriteTruthFolder, nullptr, CheckTruth}};
  return parts;
}

}  // namespace alidade
