#include "eval/dataset/dataset_images.h"

#include <fstream>
#include <optional>
#include <utility>

#include "core/format.h"
#include "core/regular_file.h"
#include "eval/dataset/sensor_table.h"
#include "eval/files/input_file.h"

namespace alidade {
namespace {

/// Width and height in the header of a PNG file: 8 bytes of signature, then the IHDR chunk with both as
/// big-endian integers (ISO/IEC 15948). Nothing when the file is no PNG: other formats are the decoder's
/// business.
std::optional<std::pair<int, int>> PngSize(const std::string& path) {
  unsigned char head[24] = {};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(head), sizeof head) || head[0] != 0x89 || head[1] != 'P') {
    return std::nullopt;
  }
  const auto number = [&head](int at) {
    return (head[at] << 24) | (head[at + 1] << 16) | (head[at + 2] << 8) | head[at + 3];
  };
  return std::pair(number(16), number(20));
}

Status CheckImage(const CsvReader& csv, const ImageEntry& image, const CameraModel& camera) {
  if (const Result<std::uintmax_t> size = RegularFileSize(image.path); !size.ok()) {
    return Status::Input(csv.Place() + ": image " + size.message());
  }
  const std::optional<std::pair<int, int>> size = PngSize(image.path);
  if (size.has_value() && (size->first != camera.width_px() || size->second != camera.height_px())) {
    return Status::Input(image.path + ": image of " + std::to_string(size->first) + " x " +
                         std::to_string(size->second) + " px, expected the resolution " +
                         std::to_string(camera.width_px()) + " x " + std::to_string(camera.height_px()) +
                         " of sensor.yaml");
  }
  return Status::Ok();
}

}  // namespace

Result<std::vector<ImageEntry>> ReadImages(const std::string& folder, const CameraModel& camera) {
  const std::string path = folder + "/data.csv";
  Result<CsvReader> csv = OpenTable(path, {{"timestamp", "ns"}, {"filename"}});
  if (!csv.ok()) {
    return csv.status();
  }
  std::vector<ImageEntry> images;
  size_t unusable = 0;
  Status first_fault;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(2));
    ImageEntry image;
    ALIDADE_RETURN_IF_ERROR(
        csv->ReadStamp(images.empty(), images.empty() ? 0 : images.back().stamp_ns, &image.stamp_ns));
    if (!StaysInFolder(csv->field(1))) {
      return csv->Fault(1, "filename", "the name of a file in the folder data beside this one");
    }
    image.path = folder + "/data/" + std::string(csv->field(1));
    if (const Status usable = CheckImage(*csv, image, camera); !usable.ok() && unusable++ == 0) {
      first_fault = usable;
    }
    images.push_back(std::move(image));
  }
  if (images.empty()) {
    return Status::Input(path + ": lists no image, expected at least one row");
  }
  // Fewer are the business of whoever decodes them.
  if (static_cast<double>(unusable) > kMaxUnreadableShare * static_cast<double>(images.size())) {
    return Status::Input(first_fault.message() +
                         Format("; %zu of %zu images cannot be used, expected at most %.0f %%", unusable,
                                images.size(), 100 * kMaxUnreadableShare));
  }
  return images;
}

}  // namespace alidade
