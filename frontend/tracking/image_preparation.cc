#include "frontend/tracking/image_preparation.h"

#include <algorithm>

namespace alidade {
namespace {

// Contrast limit and tiles: enough to see into shadows, not enough to make corners of sensor noise.
constexpr double kClaheClipLimit = 3.0;
constexpr int kClaheTiles = 8;

}  // namespace

ImagePreparation::ImagePreparation(const FrontendConfig& config, int width_px, int height_px)
    : equalize_(config.equalize),
      smooth_(config.template_px > 0),
      clahe_(cv::createCLAHE(kClaheClipLimit, cv::Size(kClaheTiles, kClaheTiles))),
      image_(height_px, width_px, CV_8UC1) {}

bool ImagePreparation::Add(const unsigned char* grey) {
  const size_t size = image_.total();
  if (!empty_ && std::equal(grey, grey + size, image_.data)) {
    return false;
  }
  empty_ = false;
  std::copy(grey, grey + size, image_.data);
  if (equalize_) {
    clahe_->apply(image_, contrasted_);
  } else {
    contrasted_ = image_;
  }
  if (smooth_) {
    // Bilinear sampling of a sharper image depends on where between the pixels it falls.
    cv::GaussianBlur(image_, smoothed_, cv::Size(3, 3), 0);
  }
  return true;
}

}  // namespace alidade
