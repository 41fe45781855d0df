#pragma once

#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/frontend_config.h"

namespace alidade {

/// Makes of each camera image what the tracker searches in.
class ImagePreparation {
 public:
  /// Size of the images [px].
  ImagePreparation(const FrontendConfig& config, int width_px, int height_px);

  /// grey: the next image, row-major 8-bit. Returns false, and keeps what was made of the image before, when
  /// it is that image to the last bit: a camera that repeats itself.
  bool Add(const unsigned char* grey);

  /// The newest image, with its contrast equalized (FrontendConfig::equalize).
  [[nodiscard]] const cv::Mat& contrasted() const { return contrasted_; }
  /// What templates are cut from; empty without templates.
  [[nodiscard]] const cv::Mat& smoothed() const { return smoothed_; }

 private:
  bool equalize_;
  bool smooth_;
  cv::Ptr<cv::CLAHE> clahe_;
  cv::Mat image_;
  bool empty_ = true;
  cv::Mat contrasted_;
  cv::Mat smoothed_;
};

}  // namespace alidade
