#pragma once

#include <string>

#include "core/status.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// Writes an 8-bit grey PNG, atomically. Low compression for speed: noise does not compress. kOutput: the
/// file cannot be written.
Status WritePng(const GreyImage& image, const std::string& path);

}  // namespace alidade
