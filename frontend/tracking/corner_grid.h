#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/frontend_config.h"

namespace alidade {

/// Keeps features spread over the image: cells of equal size share the feature budget, the emptiest is served
/// first. Positions are pixels of the image given to the constructor.
class CornerGrid {
 public:
  /// border_px: corners this close to the image's edge are not proposed.
  CornerGrid(const FrontendConfig& config, int width_px, int height_px, int border_px);

  /// Which of `pixels`, given in order of preference, stay: a feature goes when a preferred one is closer
  /// than half of min_distance_px (half, so that a track is not lost for coming a little nearer than new
  /// corners may), or when its cell holds twice its share already.
  [[nodiscard]] std::vector<bool> Thin(const std::vector<cv::Point2f>& pixels) const;

  /// New corners, sub-pixel refined, until `existing` and they make max_features. Each goes to the cell with
  /// the fewest features, min_distance_px from all others. FAST proposes (Rosten, Drummond 2006); the smaller
  /// eigenvalue of the gradient's structure tensor ranks (Shi, Tomasi 1994), since that is what conditions
  /// Lucas-Kanade. image: 8-bit grey. derivatives: its Scharr derivatives, interleaved 16-bit, of the same
  /// size.
  [[nodiscard]] std::vector<cv::Point2f> Detect(const cv::Mat& image, const cv::Mat& derivatives,
                                                const std::vector<cv::Point2f>& existing) const;

 private:
  [[nodiscard]] int CellOf(const cv::Point2f& pixel) const;
  [[nodiscard]] cv::Rect CellRect(int cell) const;
  /// Corners of one cell, best first.
  [[nodiscard]] std::vector<cv::Point2f> Propose(const cv::Mat& image, const cv::Mat& derivatives,
                                                 int cell) const;

  FrontendConfig config_;
  cv::Size size_px_;
  int border_px_;
  int cells_;
  int share_;  // features a cell holds when all hold the same
};

}  // namespace alidade
