#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace alidade {

/// A pixel with the smaller eigenvalue of its structure tensor, in squared units of the derivatives.
struct Corner {
  cv::Point2f pixel;
  float strength = 0;
};

/// How well a patch determines its own position: the eigenvalues of the structure tensor, the sum of
/// (d_x, d_y)^T (d_x, d_y) over a square patch (Shi, Tomasi, "Good features to track", 1994). The smaller one
/// is zero on a straight edge however strong it is, and the patch slides along it.
namespace corner_strength {

/// Half a side of the patch.
inline constexpr int kRadiusPx = 3;
/// A pixel nearer to the image's edge has no strength.
inline constexpr int kMarginPx = kRadiusPx + 1;

/// The smaller eigenvalue at the right angle of a step of `contrast` grey: each of the two edges crosses half
/// of the patch, and a step has two derivatives of half its height.
[[nodiscard]] float OfContrast(double contrast_grey);

/// Of a whole pixel at least kMarginPx inside. derivatives: Scharr's, interleaved 16 bit.
[[nodiscard]] float At(const cv::Mat& derivatives, const cv::Point& pixel);

/// Local maxima of the smaller eigenvalue in `area` (at least kMarginPx inside) that are at least `least` and
/// no straight edges: the smaller eigenvalue is at least kMinEdgeRatio of the larger one. Strongest first;
/// equal strengths in reading order, so that the order never depends on the sort.
[[nodiscard]] std::vector<Corner> Maxima(const cv::Mat& derivatives, const cv::Rect& area, float least);

inline constexpr float kMinEdgeRatio = 0.05F;

}  // namespace corner_strength
}  // namespace alidade
