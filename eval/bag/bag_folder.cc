#include "eval/bag/bag_folder.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/png_image.h"
#include "eval/dataset/sensor_table.h"
#include "eval/files/output_file.h"

namespace alidade {

Result<std::vector<std::string>> ConvertBagToFolder(const std::string& bag, BagImportOptions options,
                                                    const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path camera = fs::path(folder) / "mav0" / "cam0";
  std::map<TimeNs, std::string> images;  // by stamp: a bag may hold them out of order
  options.take_image = [&](const BagImage& image) {
    const bool raw = image.file.empty();
    const std::string name = std::to_string(image.stamp_ns) + "." + (raw ? "png" : image.extension);
    if (!images.try_emplace(image.stamp_ns, name).second) {
      return Status::Ok();  // two of one stamp: the first one counts
    }
    const std::string path = (camera / "data" / name).string();
    return raw ? WritePng(image.grey, path) : WriteFileAtomically(path, image.file);
  };
  Result<BagImport> import = ReadBag(bag, options);
  ALIDADE_RETURN_IF_ERROR(import.status());
  Dataset& dataset = import->dataset;
  if (!images.empty()) {
    std::string list = "#timestamp [ns],filename\n";
    for (const auto& [stamp_ns, name] : images) {
      list += std::to_string(stamp_ns) + "," + name + "\n";
      dataset.images.push_back({stamp_ns, (camera / "data" / name).string()});
    }
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((camera / "data.csv").string(), list));
    if (dataset.camera_rate_hz == 0) {
      dataset.camera_rate_hz = MeasuredRate(images.begin()->first, images.rbegin()->first, images.size());
    }
  }
  ALIDADE_RETURN_IF_ERROR(WriteDataset(dataset, folder));
  return std::move(import->remarks);
}

}  // namespace alidade
