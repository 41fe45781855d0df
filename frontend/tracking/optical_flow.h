#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/frontend_config.h"

namespace alidade {

/// Pyramidal Lucas-Kanade (Bouguet, 2000) from one image to the next.
class OpticalFlow {
 public:
  explicit OpticalFlow(const FrontendConfig& config);

  /// The next image, 8-bit grey; all of one size.
  void Add(const cv::Mat& image);

  /// The newest image and its Scharr derivatives, interleaved 16-bit.
  [[nodiscard]] const cv::Mat& image() const { return pyramid_[0]; }
  [[nodiscard]] const cv::Mat& derivatives() const { return pyramid_[1]; }

  /// Follows pixels of the image before to the newest one; `to` holds where the search starts, then where it
  /// ended. True where it converged.
  std::vector<bool> Follow(const std::vector<cv::Point2f>& from, std::vector<cv::Point2f>* to) const;

  /// Whether pixels `to` of the newest image, followed back on the finest level, arrive nearer than
  /// tolerance_px to `from`.
  [[nodiscard]] std::vector<bool> Return(const std::vector<cv::Point2f>& from,
                                         const std::vector<cv::Point2f>& to, double tolerance_px) const;

 private:
  int levels_;
  cv::Size window_;
  cv::TermCriteria criteria_;
  std::vector<cv::Mat> before_;
  std::vector<cv::Mat> pyramid_;  ///< image, derivatives, image, derivatives, ... from fine to coarse
};

}  // namespace alidade
