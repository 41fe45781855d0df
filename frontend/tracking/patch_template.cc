#include "frontend/tracking/patch_template.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

using Eigen::Matrix2f;
using Eigen::Vector2f;

constexpr int kMaxIterations = 10;
constexpr float kConvergedPx = 0.01F;
constexpr float kMaxShiftPx = 3;
// Of one call: with freedom enough any two smooth patches agree.
constexpr float kMaxChange = 0.4F;
// Patches of less contrast are noise.
constexpr float kMinDeviationGrey = 1;
// Makes H definite where the patch is an edge; changes the steps, not where they end.
constexpr float kDamping = 1e-3F;
constexpr float kMaxGrowth = 1.5F;
// Deviation of the weights. What lies far from the corner often lies at another depth.
constexpr float kSigmaPerSide = 0.23F;

/// Square roots of a Gaussian's weights over a patch; the weights' mean is one.
Eigen::VectorXf RootWeights(int side_px) {
  const float sigma = kSigmaPerSide * static_cast<float>(side_px);
  const float reach = 0.5F * static_cast<float>(side_px - 1);
  const Eigen::ArrayXf at = Eigen::ArrayXf::LinSpaced(side_px, -reach, reach);
  const Eigen::VectorXf along = (-at.square() / (4 * sigma * sigma)).exp();
  Eigen::MatrixXf both = along * along.transpose();
  both *= std::sqrt(static_cast<float>(both.size())) / both.norm();
  return both.reshaped();
}

/// Scales to zero weighted mean and unit weighted variance, times the weights' roots; returns the deviation
/// before, 0 when the patch is flat.
float Normalize(const Eigen::VectorXf& root_weights, Eigen::VectorXf* grey) {
  const auto count = static_cast<float>(grey->size());
  grey->array() -= (root_weights.array().square() * grey->array()).sum() / count;
  grey->array() *= root_weights.array();
  const float deviation = std::sqrt(grey->squaredNorm() / count);
  if (deviation < kMinDeviationGrey) {
    return 0;
  }
  *grey /= deviation;
  return deviation;
}

bool Inside(const cv::Mat& image, const Vector2f& pixel) {
  return pixel.x() >= 1 && pixel.y() >= 1 && pixel.x() < static_cast<float>(image.cols - 2) &&
         pixel.y() < static_cast<float>(image.rows - 2);
}

float Bilinear(const cv::Mat& image, float x, float y) {
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float right = x - static_cast<float>(column);
  const float down = y - static_cast<float>(row);
  const unsigned char* upper = image.ptr(row) + column;
  const unsigned char* lower = upper + image.step;
  const float top = upper[0] + right * static_cast<float>(upper[1] - upper[0]);
  const float bottom = lower[0] + right * static_cast<float>(lower[1] - lower[0]);
  return top + down * (bottom - top);
}

}  // namespace

bool PatchTemplate::Fits(const cv::Mat& image, const Vector2f& centre, int side_px) {
  const int reach_px = side_px / 2 + 2;
  const Vector2f reach = Vector2f::Constant(static_cast<float>(reach_px));
  return Inside(image, centre - reach) && Inside(image, centre + reach);
}

PatchTemplate::PatchTemplate(const cv::Mat& image, const Vector2f& centre, int side_px) : side_px_(side_px) {
  // Whole pixels, so that the template itself is not interpolated.
  const int left = static_cast<int>(std::lround(centre.x())) - side_px / 2;
  const int top = static_cast<int>(std::lround(centre.y())) - side_px / 2;
  corner_ = Vector2f(static_cast<float>(left), static_cast<float>(top)) - centre;
  const Eigen::Index count = Eigen::Index{side_px} * side_px;
  Eigen::VectorXf grey(count);
  jacobian_.resize(count, 6);
  Eigen::Index i = 0;
  for (int y = top; y < top + side_px; ++y) {
    const unsigned char* row = image.ptr(y);
    for (int x = left; x < left + side_px; ++x, ++i) {
      grey[i] = row[x];
      const Vector2f slope(0.5F * static_cast<float>(row[x + 1] - row[x - 1]),
                           0.5F * static_cast<float>(image.ptr(y + 1)[x] - image.ptr(y - 1)[x]));
      const Vector2f at = Vector2f(static_cast<float>(x), static_cast<float>(y)) - centre;
      jacobian_.row(i) << slope.x(), slope.y(), slope.x() * at.x(), slope.x() * at.y(), slope.y() * at.x(),
          slope.y() * at.y();
    }
  }
  root_weights_ = RootWeights(side_px);
  const float deviation = Normalize(root_weights_, &grey);
  if (!(deviation > 0)) {
    return;
  }
  grey_ = std::move(grey);
  jacobian_.array().colwise() *= root_weights_.array();
  jacobian_ /= deviation;
  // Gain and offset projected out: a column's share of the template and of a constant.
  jacobian_ -= root_weights_ * (root_weights_.transpose() * jacobian_ / static_cast<float>(count)).eval();
  jacobian_ -= grey_ * (grey_.transpose() * jacobian_ / static_cast<float>(count)).eval();
  Matrix6f hessian = jacobian_.transpose() * jacobian_;
  hessian.diagonal() *= 1 + kDamping;
  inverse_ = hessian.ldlt().solve(Matrix6f::Identity());
}

bool PatchTemplate::Sample(const cv::Mat& image, const TemplateMatch& match, Eigen::VectorXf* grey) const {
  const Vector2f right = match.affine.col(0);
  const Vector2f down = match.affine.col(1);
  const Vector2f start = match.centre + match.affine * corner_;
  const auto last = static_cast<float>(side_px_ - 1);
  if (!Inside(image, start) || !Inside(image, start + last * right) || !Inside(image, start + last * down) ||
      !Inside(image, start + last * (right + down))) {
    return false;
  }
  float* out = grey->data();
  for (int row = 0; row < side_px_; ++row) {
    const Vector2f line = start + static_cast<float>(row) * down;
    for (int column = 0; column < side_px_; ++column) {
      const auto along = static_cast<float>(column);
      *out++ = Bilinear(image, line.x() + along * right.x(), line.y() + along * right.y());
    }
  }
  return true;
}

bool PatchTemplate::Align(const cv::Mat& image, TemplateMatch* match) const {
  if (empty()) {
    return false;
  }
  TemplateMatch now = *match;
  Eigen::VectorXf grey(grey_.size());
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!Sample(image, now, &grey) || !(Normalize(root_weights_, &grey) > 0)) {
      return false;
    }
    now.correlation = grey.dot(grey_) / static_cast<float>(grey.size());
    // The template itself has no share in the Jacobian's columns, so that it need not be subtracted.
    const Vector6f gradient = jacobian_.transpose() * grey;
    const Vector6f step = inverse_ * gradient;
    Matrix2f change = Matrix2f::Identity();
    change(0, 0) += step[2];
    change(0, 1) += step[3];
    change(1, 0) += step[4];
    change(1, 1) += step[5];
    if (!(change.determinant() > 0.1F)) {
      return false;
    }
    now.affine = now.affine * change.inverse();
    const Vector2f shift = now.affine * step.head<2>();
    now.centre -= shift;
    if (!((now.centre - match->centre).norm() < kMaxShiftPx) ||
        !((now.affine - match->affine).norm() < kMaxChange)) {
      return false;
    }
    if (shift.norm() < kConvergedPx) {
      break;
    }
  }
  // Mean square of the difference of two patches of unit variance, over both coordinates of the centre.
  const float difference = 2 * std::max(0.0F, 1 - now.correlation);
  now.deviation_px = std::sqrt(difference * 0.5F * inverse_.topLeftCorner<2, 2>().trace());
  *match = now;
  return true;
}

bool PatchTemplate::IsWornOut(const Matrix2f& affine) {
  // Singular values of a 2 x 2 matrix from its norm and determinant.
  const float half = 0.5F * affine.squaredNorm();
  const float area = affine.determinant();
  const float root = std::sqrt(std::max(0.0F, half * half - area * area));
  return half + root > kMaxGrowth * kMaxGrowth || half - root < 1 / (kMaxGrowth * kMaxGrowth);
}

}  // namespace alidade
