#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace alidade {

/// Where a template lies in another image: a pixel at x from the corner there is at centre + affine x here.
struct TemplateMatch {
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();      ///< pixel of the corner
  Eigen::Matrix2f affine = Eigen::Matrix2f::Identity();  ///< deformation of its surroundings
  float correlation = 0;                                 ///< of the two patches, at most 1
  float deviation_px = 0;  ///< of the centre, if their difference is white noise
};

/// The patch around a corner in the image where its track began. Going from frame to frame, a track slides: a
/// window that turns, grows or leans is matched as if it shifted, and what that pulls aside adds up. Matched
/// to the first image, under the affine deformation a small planar patch undergoes, errors do not add up
/// (Shi, Tomasi, "Good features to track", 1994).
///
/// Inverse compositional alignment (Baker, Matthews, "Lucas-Kanade 20 years on", 2004) of the zero-mean,
/// unit-variance patch under Gaussian weights w, gain and offset projected out:
///
///   H = sum w s s^T,  b = sum w s e,  e = I(c + A x) - T(x),  s = grad T [1 0 x y 0 0; 0 1 0 0 x y] without
///   its share of T,  (dc, dA) = H^-1 b,  A <- A (I + dA)^-1,  c <- c - A dc
class PatchTemplate {
 public:
  PatchTemplate() = default;
  /// image: 8-bit grey, the patch inside it with a pixel to spare (Fits).
  PatchTemplate(const cv::Mat& image, const Eigen::Vector2f& centre, int side_px);

  [[nodiscard]] static bool Fits(const cv::Mat& image, const Eigen::Vector2f& centre, int side_px);

  /// Improves `match`, which must lie within a pixel or two. False when the patch leaves the image, is flat,
  /// or does not converge near its start.
  [[nodiscard]] bool Align(const cv::Mat& image, TemplateMatch* match) const;

  /// Whether the deformation is so large that image detail and template no longer compare.
  [[nodiscard]] static bool IsWornOut(const Eigen::Matrix2f& affine);

  [[nodiscard]] bool empty() const { return grey_.size() == 0; }

 private:
  using Vector6f = Eigen::Matrix<float, 6, 1>;
  using Matrix6f = Eigen::Matrix<float, 6, 6>;

  bool Sample(const cv::Mat& image, const TemplateMatch& match, Eigen::VectorXf* grey) const;

  int side_px_ = 0;
  Eigen::Vector2f corner_ = Eigen::Vector2f::Zero();  ///< first pixel of the patch, from the corner
  Eigen::VectorXf root_weights_;                      ///< of the pixels; row-major, as all below
  Eigen::VectorXf grey_;                              ///< zero mean, unit variance, times the roots
  Eigen::Matrix<float, Eigen::Dynamic, 6> jacobian_;  ///< s of every pixel
  Matrix6f inverse_ = Matrix6f::Zero();               ///< of H
};

}  // namespace alidade
