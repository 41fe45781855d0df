#include "frontend/tracking/optical_flow.h"

#include <opencv2/video/tracking.hpp>
#include <utility>

namespace alidade {
namespace {

// A patch needs this smaller eigenvalue a pixel (OpenCV's normalisation) for its position to be defined.
constexpr double kMinEigenvalue = 1e-4;

/// A multiple of four: OpenCV's vector code leaves the rest of each row to a loop that doubles the time.
cv::Size WindowOf(const FrontendConfig& config) {
  const int side_px = (config.window_px + 3) / 4 * 4;
  return {side_px, side_px};
}

/// Where a template is matched afterwards, its neighbourhood is enough.
cv::TermCriteria CriteriaOf(const FrontendConfig& config) {
  const bool rough = config.template_px > 0;
  return {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, rough ? 10 : 20, rough ? 0.1 : 0.03};
}

}  // namespace

OpticalFlow::OpticalFlow(const FrontendConfig& config)
    : levels_(config.pyramid_levels), window_(WindowOf(config)), criteria_(CriteriaOf(config)) {}

void OpticalFlow::Add(const cv::Mat& image) {
  std::swap(pyramid_, before_);
  // The derivatives serve this frame's backward pass, the ranking of corners, and the next frame's forward
  // pass.
  cv::buildOpticalFlowPyramid(image, pyramid_, window_, levels_, true, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, false);
}

std::vector<bool> OpticalFlow::Follow(const std::vector<cv::Point2f>& from,
                                      std::vector<cv::Point2f>* to) const {
  std::vector<unsigned char> found;
  cv::calcOpticalFlowPyrLK(before_, pyramid_, from, *to, found, cv::noArray(), window_, levels_, criteria_,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  return {found.begin(), found.end()};
}

std::vector<bool> OpticalFlow::Return(const std::vector<cv::Point2f>& from,
                                      const std::vector<cv::Point2f>& to, double tolerance_px) const {
  std::vector<bool> returned(from.size());
  if (from.empty()) {
    return returned;
  }
  std::vector<unsigned char> found;
  std::vector<cv::Point2f> back = from;
  cv::calcOpticalFlowPyrLK(pyramid_, before_, to, back, found, cv::noArray(), window_, 0, criteria_,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  for (size_t i = 0; i < from.size(); ++i) {
    returned[i] = found[i] != 0 && cv::norm(back[i] - from[i]) < tolerance_px;
  }
  return returned;
}

}  // namespace alidade
