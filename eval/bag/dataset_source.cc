#include "eval/bag/dataset_source.h"

#include "eval/bag/bag_import.h"
#include "eval/bag/bag_parts.h"
#include "eval/dataset/calibration_import.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/digest.h"
#include "eval/dataset/log_tables.h"
#include "eval/files/hash.h"

namespace alidade {

Result<Dataset> ReadDataset(const DatasetSource& source, const DatasetStorage& storage) {
  if (!IsBag(source.path)) {
    if (!source.topics.empty() || !source.calibration.empty()) {
      return Status::Usage(source.path +
                           ": is not a bag; topics and calibration apply to bags, a folder has its own "
                           "sensor.yaml");
    }
    DatasetStorage followed = storage;
    followed.follow_links = storage.follow_links || source.follow_links;
    return ReadDataset(source.path, followed);
  }
  if (source.follow_links) {
    return Status::Usage(source.path + ": is a bag; follow_links applies to folders");
  }
  BagImportOptions options;
  ALIDADE_RETURN_IF_ERROR(MakeBagTopics(source.topics).status());  // before the calibration's errors
  options.topics = source.topics;
  if (!source.calibration.empty()) {
    Result<ImportedCalibration> calibration = ImportCalibration(source.calibration, source.camera);
    ALIDADE_RETURN_IF_ERROR(calibration.status());
    options.imu = calibration->imu;
    options.imu_is_per_sample = calibration->imu_is_per_sample;
    options.camera = std::move(calibration->camera);
  }
  Result<BagImport> import = ReadBag(source.path, options);
  ALIDADE_RETURN_IF_ERROR(import.status());
  import->dataset.remarks = std::move(import->remarks);
  if (!storage.spool_folder.empty()) {
    ALIDADE_RETURN_IF_ERROR(MoveTablesToFiles(storage.spool_folder, &import->dataset));
  }
  return std::move(import->dataset);
}

Result<std::string> DigestOf(const DatasetSource& source) {
  Result<std::string> digest = DigestOfFolder(source.path);
  if (!digest.ok() || (source.topics.empty() && source.calibration.empty())) {
    return digest;
  }
  Hash hash;
  hash.Add(*digest + source.topics + "\n" + source.camera + "\n");
  for (const std::string& file : source.calibration) {
    const Result<std::string> of_file = DigestOfFolder(file);
    ALIDADE_RETURN_IF_ERROR(of_file.status());
    hash.Add(*of_file);
  }
  return hash.Hex();
}

}  // namespace alidade
