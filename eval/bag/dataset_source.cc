#include "eval/bag/dataset_source.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "eval/bag/bag_import.h"
#include "eval/bag/bag_parts.h"
#include "eval/dataset/calibration_import.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/digest.h"
#include "eval/dataset/log_tables.h"
#include "eval/files/hash.h"

namespace alidade {
namespace {

Result<Dataset> ReadFolder(const DatasetSource& source, const DatasetStorage& storage) {
  DatasetStorage followed = storage;
  followed.follow_links = storage.follow_links || source.follow_links;
  return ReadDataset(source.path, followed);
}

Result<Dataset> ReadBagOf(const DatasetSource& source, const DatasetStorage& storage) {
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

/// The first is that of every folder.
constexpr std::array kFormats = {
    DatasetFormat{
        .name = "a folder", .extension = "", .is_asl = true, .takes_topics = false, .read = ReadFolder},
    DatasetFormat{
        .name = "a bag", .extension = ".bag", .is_asl = false, .takes_topics = true, .read = ReadBagOf},
};

}  // namespace

const DatasetFormat& FormatOf(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return kFormats.front();
  }
  const auto* const format =
      std::find_if(kFormats.begin(), kFormats.end(), [&path](const DatasetFormat& candidate) {
        return candidate.is_file() && path.ends_with(candidate.extension);
      });
  return format == kFormats.end() ? kFormats.front() : *format;
}

bool IsDataset(const std::string& path) {
  std::error_code ignored;
  return FormatOf(path).is_file() ? std::filesystem::is_regular_file(path, ignored)
                                  : std::filesystem::is_directory(path, ignored);
}

std::string FormatsWith(bool DatasetFormat::*trait) {
  std::string names;
  for (const DatasetFormat& format : kFormats) {
    if (format.*trait) {
      names += (names.empty() ? "" : " or ") + std::string(format.name);
    }
  }
  return names;
}

Result<Dataset> ReadDataset(const DatasetSource& source, const DatasetStorage& storage) {
  const DatasetFormat& format = FormatOf(source.path);
  const std::string found = source.path + ": found " + std::string(format.name) + ", expected ";
  if (!format.takes_topics && (!source.topics.empty() || !source.calibration.empty())) {
    return Status::Usage(found + FormatsWith(&DatasetFormat::takes_topics) + " for topics or calibration");
  }
  if (!format.is_asl && source.follow_links) {
    return Status::Usage(found + FormatsWith(&DatasetFormat::is_asl) + " for follow_links");
  }
  return format.read(source, storage);
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
