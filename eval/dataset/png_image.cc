#include "eval/dataset/png_image.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "eval/files/output_file.h"

namespace alidade {

Status WritePng(const GreyImage& image, const std::string& path) {
  // OpenCV has no view of constant memory; the pixels are only read.
  const cv::Mat pixels(image.height_px, image.width_px, CV_8UC1,
                       const_cast<unsigned char*>(image.pixels.data()));
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", pixels, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
    return Status::Output(path + ": the image cannot be encoded as PNG");
  }
  return WriteFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace alidade
