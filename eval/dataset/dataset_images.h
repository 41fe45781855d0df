#pragma once

#include <string>
#include <vector>

#include "core/camera_model.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// The images that `folder`/data.csv lists, in `folder`/data, not decoded. Errors (kInput): no row; a row
/// that is none; a name that leaves the folder; more than kMaxUnreadableShare of them missing or of another
/// size than the camera's.
[[nodiscard]] Result<std::vector<ImageEntry>> ReadImages(const std::string& folder,
                                                         const CameraModel& camera);

}  // namespace alidade
