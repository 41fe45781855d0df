#include "eval/dataset/dataset_writer.h"

#include <filesystem>

#include "eval/dataset/dataset_parts.h"

namespace alidade {

Status WriteDataset(const Dataset& dataset, const std::string& path) {
  const std::string mav = (std::filesystem::path(path) / "mav0").string();
  for (const DatasetPart& part : DatasetParts()) {
    if (part.write != nullptr) {
      ALIDADE_RETURN_IF_ERROR(part.write(dataset, mav));
    }
  }
  return Status::Ok();
}

}  // namespace alidade
