#include "eval/dataset/dataset_reader.h"

#include <filesystem>

#include "eval/dataset/dataset_parts.h"
#include "eval/dataset/log_tables.h"
#include "eval/files/input_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

Status CheckFolders(const std::string& path, const fs::path& mav) {
  ALIDADE_RETURN_IF_ERROR(ExpectFolder(path, "a sequence (a folder that holds mav0)"));
  if (!MayBeFolder(mav.string())) {
    const bool inside = MayBeFolder(path + "/imu0");
    return Status::Input(path + ": expected a folder mav0 in it" +
                         (inside ? " (this seems to be mav0 itself: give the folder that contains it)" : ""));
  }
  if (!MayBeFolder((mav / "cam0").string()) && !MayBeFolder((mav / "gnss0").string())) {
    return Status::Input((mav / "cam0").string() +
                         ": no such folder, expected a camera (or gnss0 beside it)");
  }
  return Status::Ok();
}

}  // namespace

Result<Dataset> ReadDataset(const std::string& path, const DatasetStorage& storage) {
  const fs::path mav = fs::path(path) / "mav0";
  ALIDADE_RETURN_IF_ERROR(CheckFolders(path, mav));
  Dataset dataset;
  dataset.path = path;
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(path, ignored);
  dataset.name = whole.has_filename() ? whole.filename().string() : whole.parent_path().filename().string();
  if (!storage.spool_folder.empty()) {
    dataset.tables = std::make_shared<LogTables>();
  }
  for (const DatasetPart& part : DatasetParts()) {
    if (part.read != nullptr) {
      ALIDADE_RETURN_IF_ERROR(part.read(mav.string(), storage, &dataset));
    }
  }
  return dataset;
}

}  // namespace alidade
