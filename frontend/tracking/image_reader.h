#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/status.h"

namespace alidade {

/// Decodes an 8-bit or 16-bit image file to grey. kInput: missing, or does not decode, naming the path.
struct GreyImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<unsigned char> pixels;
};
Result<GreyImage> ReadGreyImage(const std::string& path);
/// The same of the bytes of such a file; `name` stands in messages.
Result<GreyImage> DecodeGreyImage(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace alidade
