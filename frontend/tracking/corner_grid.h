#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/frontend_config.h"
#include "frontend/tracking/corner_strength.h"

namespace alidade {

/// Keeps features spread over the image: cells of equal size share the feature budget, the emptiest is served
/// first. Positions are pixels of the image given to the constructor.
class CornerGrid {
 public:
  /// border_px: corners this close to the image's edge are not proposed, nor those that
  /// FrontendConfig::edge_share excludes.
  CornerGrid(const FrontendConfig& config, int width_px, int height_px, int border_px);

  /// Which of `pixels`, given in order of preference, stay: a feature goes when a preferred one is closer
  /// than half of min_distance_px (half, so that a track is not lost for coming a little nearer than new
  /// corners may).
  [[nodiscard]] std::vector<bool> Thin(const std::vector<cv::Point2f>& pixels) const;

  /// New corners, sub-pixel refined, until `existing` and they make max_features. Each goes to the cell with
  /// the fewest features, min_distance_px from all others, strongest first
  /// (frontend/tracking/corner_strength.h). Refused: less contrast than corner_threshold, straight edges,
  /// patches that are saturated in part, and what is much weaker than the strongest corner of the image, as
  /// far as it was searched, or of `existing`: in a sharp image of much contrast there are better ones, in a
  /// blurred one there are none. So there may be fewer than max_features. image: 8-bit grey. derivatives: its
  /// Scharr derivatives, interleaved 16-bit, of the same size.
  [[nodiscard]] std::vector<cv::Point2f> Detect(const cv::Mat& image, const cv::Mat& derivatives,
                                                const std::vector<cv::Point2f>& existing);

  /// A cell in which no corner was left to take is not searched in so many of the next images, unless fewer
  /// than half of the features are left: walls stay bare for a while, and the search is not free.
  static constexpr int kRestImages = 4;

 private:
  [[nodiscard]] int CellOf(const cv::Point2f& pixel) const;
  [[nodiscard]] cv::Rect CellRect(int cell) const;
  /// The image without a border.
  [[nodiscard]] cv::Rect Without(int border_px) const;
  /// Corners of one cell, strongest first.
  [[nodiscard]] std::vector<Corner> Propose(const cv::Mat& image, const cv::Mat& derivatives, int cell) const;
  /// Cells that do not rest, in an image that has so many features already; called once an image.
  [[nodiscard]] std::vector<int> CellsToSearch(size_t features);
  [[nodiscard]] float StrongestOf(const cv::Mat& derivatives, const std::vector<cv::Point2f>& pixels) const;

  FrontendConfig config_;
  cv::Size size_px_;
  int border_px_;
  int cells_;
  std::vector<int> rest_;  // images in which a cell is not searched
  int share_;              // features a cell holds when all hold the same
};

}  // namespace alidade
