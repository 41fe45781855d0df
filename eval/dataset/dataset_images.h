#pragma once

#include <string>
#include <vector>

#include "core/camera_model.h"
#include "eval/dataset/dataset.h"
#include "eval/files/csv.h"

namespace alidade {

/// Path of the image that the present row of `folder`/data.csv names in its second column. Errors (kInput): a
/// name that leaves `folder`/data; an image that is itself a link to a file outside of the sequence, of the
/// folder of images and of the list's folder, wherever these are linked to: a sequence from elsewhere must
/// not make other files of this machine read.
[[nodiscard]] Result<std::string> ImagePath(const CsvReader& csv, const std::string& folder);

/// The images that `folder`/data.csv lists, in `folder`/data, not decoded. Errors (kInput): no row; a row
/// that is none; a path that ImagePath refuses; more than kMaxUnreadableShare of them missing or of another
/// size than the camera's.
[[nodiscard]] Result<std::vector<ImageEntry>> ReadImages(const std::string& folder,
                                                         const CameraModel& camera);

}  // namespace alidade
