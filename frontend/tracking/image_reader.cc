#include "frontend/tracking/image_reader.h"

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "core/regular_file.h"

namespace alidade {
namespace {

constexpr std::uintmax_t kMaxImageBytes = std::uintmax_t{1} << 28;

Result<std::vector<unsigned char>> ReadBytes(const std::string& path) {
  const Result<std::uintmax_t> size = RegularFileSize(path);
  ALIDADE_RETURN_IF_ERROR(size.status());
  if (*size > kMaxImageBytes) {
    return Status::Input(path + ": holds " + std::to_string(*size) + " bytes, expected an image of at most " +
                         std::to_string(kMaxImageBytes));
  }
  std::ifstream file(path, std::ios::binary);
  std::vector<unsigned char> bytes(*size);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    return Status::Input(path + ": cannot be read");
  }
  return bytes;
}

}  // namespace

Result<GreyImage> ReadGreyImage(const std::string& path) {
  const Result<std::vector<unsigned char>> bytes = ReadBytes(path);
  ALIDADE_RETURN_IF_ERROR(bytes.status());
  return DecodeGreyImage(*bytes, path);
}

Result<GreyImage> DecodeGreyImage(std::span<const unsigned char> bytes, const std::string& name) {
  cv::Mat decoded;
  try {
    // The orientation tag is ignored: the calibration belongs to the pixels as stored.
    if (!bytes.empty()) {
      const cv::Mat file(1, static_cast<int>(bytes.size()), CV_8U, const_cast<unsigned char*>(bytes.data()));
      decoded =
          cv::imdecode(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
    }
  } catch (const cv::Exception& exception) {
    return Status::Input(name + ": does not decode as an image: " + exception.what());
  }
  if (decoded.empty()) {
    return Status::Input(name + ": does not decode as an image (" + std::to_string(bytes.size()) + " bytes)");
  }
  if (decoded.depth() == CV_16U) {
    cv::Mat narrowed;
    decoded.convertTo(narrowed, CV_8U, 255.0 / 65535.0);
    decoded = narrowed;
  }
  if (decoded.depth() != CV_8U) {
    return Status::Input(name + ": expected 8 or 16 bit a sample, found OpenCV depth " +
                         std::to_string(decoded.depth()));
  }
  GreyImage image{.width_px = decoded.cols, .height_px = decoded.rows, .pixels = {}};
  image.pixels.reserve(decoded.total());
  for (int row = 0; row < decoded.rows; ++row) {
    image.pixels.insert(image.pixels.end(), decoded.ptr(row), decoded.ptr(row) + decoded.cols);
  }
  return image;
}

}  // namespace alidade
