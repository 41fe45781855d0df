#include "frontend/tracking/corner_strength.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace alidade::corner_strength {
namespace {

constexpr int kSidePx = 2 * kRadiusPx + 1;
// Of Scharr's operator, 3 + 10 + 3 on either side over a distance of two pixels, per grey value a pixel.
constexpr double kDerivativeGain = 32;

struct Tensor {
  float xx = 0;
  float xy = 0;
  float yy = 0;
};

struct Eigenvalues {
  float smaller = 0;
  float larger = 0;
};

Eigenvalues Solve(const Tensor& tensor) {
  const float mean = 0.5F * (tensor.xx + tensor.yy);
  const float half_difference = 0.5F * (tensor.xx - tensor.yy);
  const float root = std::sqrt(half_difference * half_difference + tensor.xy * tensor.xy);
  return {mean - root, mean + root};
}

/// Strengths of an area, a row at a time from above. Sums over the rows of the patch are kept for each
/// column, as integers, so that a row that leaves takes away exactly what it brought.
class RowByRow {
 public:
  /// x, width: of the area. first_y: of its first row.
  RowByRow(const cv::Mat& derivatives, int x, int first_y, int width, float least)
      : derivatives_(derivatives), x_(x - kRadiusPx), y_(first_y), width_(width), least_(least) {
    columns_.fill(std::vector<int>(static_cast<std::size_t>(width + 2 * kRadiusPx)));
    across_.fill(std::vector<int>(static_cast<std::size_t>(width)));
    for (int row = first_y - kRadiusPx; row < first_y + kRadiusPx; ++row) {
      AddRow<1>(row);
    }
  }

  /// Strengths of the next row, zero where there is no corner.
  void Next(std::vector<float>* strengths) {
    AddRow<1>(y_ + kRadiusPx);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      SumAcross(columns_[k].data(), across_[k].data());
    }
    for (int i = 0; i < width_; ++i) {
      (*strengths)[static_cast<std::size_t>(i)] = StrengthOf(static_cast<std::size_t>(i));
    }
    AddRow<-1>(y_ - kRadiusPx);
    ++y_;
  }

 private:
  template <int kSign>
  void AddRow(int row) {
    const short* const derivatives = derivatives_.ptr<short>(row) + 2 * x_;
    int* const xx = columns_[0].data();
    int* const xy = columns_[1].data();
    int* const yy = columns_[2].data();
    const int count = width_ + 2 * kRadiusPx;
    for (int i = 0; i < count; ++i) {
      const int dx = derivatives[2 * i];
      const int dy = derivatives[2 * i + 1];
      xx[i] += kSign * dx * dx;
      xy[i] += kSign * dx * dy;
      yy[i] += kSign * dy * dy;
    }
  }

  void SumAcross(const int* columns, int* sums) const {
    static_assert(kSidePx == 7);
    for (int i = 0; i < width_; ++i) {
      sums[i] = columns[i] + columns[i + 1] + columns[i + 2] + columns[i + 3] + columns[i + 4] +
                columns[i + 5] + columns[i + 6];
    }
  }

  [[nodiscard]] float StrengthOf(std::size_t i) const {
    const Tensor tensor{static_cast<float>(across_[0][i]), static_cast<float>(across_[1][i]),
                        static_cast<float>(across_[2][i])};
    // The smaller eigenvalue is at most the smaller diagonal element.
    if (std::min(tensor.xx, tensor.yy) < least_) {
      return 0;
    }
    const Eigenvalues found = Solve(tensor);
    return found.smaller >= least_ && found.smaller >= kMinEdgeRatio * found.larger ? found.smaller : 0;
  }

  const cv::Mat& derivatives_;
  int x_;
  int y_;
  int width_;
  float least_;
  std::array<std::vector<int>, 3> columns_;  ///< xx, xy, yy
  std::array<std::vector<int>, 3> across_;
};

/// Whether `here` is above its eight neighbours in three rows; of two equal ones the first in reading order.
bool IsMaximum(const std::array<std::vector<float>, 3>& rows, std::size_t x) {
  const float here = rows[1][x];
  bool above = here > 0 && rows[1][x - 1] < here && rows[1][x + 1] <= here;
  for (std::size_t i = x - 1; i <= x + 1; ++i) {
    above = above && rows[0][i] < here && rows[2][i] <= here;
  }
  return above;
}

}  // namespace

float OfContrast(double contrast_grey) {
  const double slope = kDerivativeGain * 0.5 * contrast_grey;
  return static_cast<float>(0.5 * kSidePx * 2 * slope * slope);
}

float At(const cv::Mat& derivatives, const cv::Point& pixel) {
  Tensor tensor;
  for (int y = pixel.y - kRadiusPx; y <= pixel.y + kRadiusPx; ++y) {
    const short* row = derivatives.ptr<short>(y) + 2 * (pixel.x - kRadiusPx);
    for (int i = 0; i < kSidePx; ++i) {
      const float dx = row[2 * i];
      const float dy = row[2 * i + 1];
      tensor.xx += dx * dx;
      tensor.xy += dx * dy;
      tensor.yy += dy * dy;
    }
  }
  return Solve(tensor).smaller;
}

std::vector<Corner> Maxima(const cv::Mat& derivatives, const cv::Rect& area, float least) {
  std::vector<Corner> maxima;
  if (area.empty()) {
    return maxima;
  }
  // One more pixel all around, to compare with.
  const int width = area.width + 2;
  RowByRow strengths(derivatives, area.x - 1, area.y - 1, width, least);
  std::array<std::vector<float>, 3> rows;
  rows.fill(std::vector<float>(static_cast<std::size_t>(width)));
  strengths.Next(&rows[1]);
  strengths.Next(&rows[2]);
  for (int y = 0; y < area.height; ++y) {
    std::rotate(rows.begin(), rows.begin() + 1, rows.end());
    strengths.Next(&rows[2]);
    for (int x = 0; x < area.width; ++x) {
      const auto at = static_cast<std::size_t>(x + 1);
      if (IsMaximum(rows, at)) {
        maxima.push_back({cv::Point2f(cv::Point(area.x + x, area.y + y)), rows[1][at]});
      }
    }
  }
  std::stable_sort(maxima.begin(), maxima.end(),
                   [](const Corner& a, const Corner& b) { return a.strength > b.strength; });
  return maxima;
}

}  // namespace alidade::corner_strength
