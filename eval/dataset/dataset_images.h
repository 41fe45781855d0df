#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "eval/dataset/dataset.h"
#include "eval/files/csv.h"

namespace alidade {

/// A camera's folder with data.csv and the images in data.
class ImageFolder {
 public:
  /// follow_links: images may be links to any file. Otherwise they may lead to the sequence, the folder of
  /// images and the list's folder, wherever these are linked to: a sequence from elsewhere must not make
  /// other files of this machine read.
  ImageFolder(std::string folder, bool follow_links);

  /// Path of the image that the present row of data.csv names in its second column. Errors (kInput): a name
  /// that leaves `folder`/data; an image that is itself a link elsewhere, without follow_links.
  [[nodiscard]] Result<std::string> PathOf(const CsvReader& csv);

 private:
  /// Whether a file is in the sequence, or in `folder`, where an image that leads to it is listed.
  bool IsWithin(const std::filesystem::path& file, const std::filesystem::path& folder);

  std::filesystem::path data_;
  bool follow_links_;
  bool resolved_ = false;                      ///< places_ is known
  std::vector<std::filesystem::path> places_;  ///< canonical
  std::filesystem::path last_;                 ///< folder of the last image that is a link
  std::filesystem::path last_place_;           ///< canonical
};

/// The images that `folder`/data.csv lists, in `folder`/data, not decoded. Errors (kInput): no row; a row
/// that is none; a path that ImageFolder refuses; more than kMaxUnreadableShare of them missing or of another
/// size than the camera's.
[[nodiscard]] Result<std::vector<ImageEntry>> ReadImages(const std::string& folder, const CameraModel& camera,
                                                         bool follow_links = false);

}  // namespace alidade
