#include "eval/dataset/dataset_images.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "core/format.h"
#include "core/regular_file.h"
#include "eval/dataset/sensor_table.h"
#include "eval/files/input_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

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

/// Where a link leads that is the image itself, not a folder above it; nothing when `image` is no such link,
/// or leads nowhere.
std::optional<fs::path> LinkTarget(const fs::path& image) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(image, error))) {
    return std::nullopt;
  }
  const fs::path target = fs::canonical(image, error);
  return error ? std::nullopt : std::optional(target);
}

/// Whether a path is `folder` or below it; both canonical, an empty folder holds nothing.
bool StartsWith(const fs::path& path, const fs::path& folder) {
  return !folder.empty() &&
         std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

ImageFolder::ImageFolder(std::string folder, bool follow_links)
    : data_(fs::path(std::move(folder)) / "data"), follow_links_(follow_links) {}

bool ImageFolder::IsWithin(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  if (!resolved_) {
    resolved_ = true;
    const fs::path camera = data_.parent_path();
    const fs::path mav = camera.parent_path();
    // Of a sequence of links to the files of another one.
    const fs::path list = fs::canonical(camera / "data.csv", error);
    for (const fs::path& place : {data_, camera, list.parent_path(), mav, mav.parent_path()}) {
      places_.push_back(fs::canonical(place, error));
    }
  }
  if (last_ != folder) {
    last_ = folder;
    last_place_ = fs::canonical(folder, error);
  }
  return StartsWith(file, last_place_) ||
         std::any_of(places_.begin(), places_.end(), [&file](const auto& p) { return StartsWith(file, p); });
}

Result<std::string> ImageFolder::PathOf(const CsvReader& csv) {
  constexpr size_t kColumn = 1;
  if (!StaysInFolder(csv.field(kColumn))) {
    return csv.Fault(kColumn, "filename", "the name of a file in the folder data beside this one");
  }
  const fs::path image = data_ / csv.field(kColumn);
  if (!follow_links_) {
    const std::optional<fs::path> target = LinkTarget(image);
    if (target && !IsWithin(*target, image.parent_path())) {
      return csv.Fault(
          kColumn, "filename",
          "a file of this sequence, not a link to " + target->string() +
              " outside of it (a link in place of the folder is fine; --follow_links takes links "
              "of single images, and in a plan follow_links: true)");
    }
  }
  return image.string();
}

Result<std::vector<ImageEntry>> ReadImages(const std::string& folder, const CameraModel& camera,
                                           bool follow_links) {
  const std::string path = folder + "/data.csv";
  Result<CsvReader> csv = OpenTable(path, {{"timestamp", "ns"}, {"filename"}});
  if (!csv.ok()) {
    return csv.status();
  }
  ImageFolder image_folder(folder, follow_links);
  std::vector<ImageEntry> images;
  size_t unusable = 0;
  Status first_fault;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(2));
    ImageEntry image;
    ALIDADE_RETURN_IF_ERROR(
        csv->ReadStamp(images.empty(), images.empty() ? 0 : images.back().stamp_ns, &image.stamp_ns));
    Result<std::string> path_of_image = image_folder.PathOf(*csv);
    ALIDADE_RETURN_IF_ERROR(path_of_image.status());
    image.path = std::move(path_of_image).value();
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
