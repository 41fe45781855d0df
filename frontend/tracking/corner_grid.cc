#include "frontend/tracking/corner_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace alidade {
namespace {

constexpr int kSubPixelRadiusPx = 3;
// Black or white: less than the quarter that the corner of a lamp covers.
constexpr double kMaxSaturatedShare = 0.15;
// Of the strongest corner: a tenth of its contrast. Weaker ones do not live long beside it.
constexpr float kMinRelativeStrength = 0.01F;

/// Points hashed into square buckets as wide as the radius asked about, so that a query visits nine of them.
class Neighbourhood {
 public:
  Neighbourhood(const cv::Size& size_px, double radius_px)
      : radius_px_(radius_px),
        columns_(static_cast<int>(size_px.width / radius_px) + 1),
        rows_(static_cast<int>(size_px.height / radius_px) + 1),
        buckets_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_)) {}

  void Add(const cv::Point2f& pixel) { buckets_[Index(Column(pixel), Row(pixel))].push_back(pixel); }

  [[nodiscard]] bool HasNear(const cv::Point2f& pixel) const {
    for (int row = std::max(0, Row(pixel) - 1); row <= std::min(rows_ - 1, Row(pixel) + 1); ++row) {
      for (int column = std::max(0, Column(pixel) - 1); column <= std::min(columns_ - 1, Column(pixel) + 1);
           ++column) {
        for (const cv::Point2f& other : buckets_[Index(column, row)]) {
          if (cv::norm(other - pixel) < radius_px_) {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] int Column(const cv::Point2f& pixel) const {
    return std::clamp(static_cast<int>(pixel.x / radius_px_), 0, columns_ - 1);
  }
  [[nodiscard]] int Row(const cv::Point2f& pixel) const {
    return std::clamp(static_cast<int>(pixel.y / radius_px_), 0, rows_ - 1);
  }
  [[nodiscard]] size_t Index(int column, int row) const {
    return static_cast<size_t>(row * columns_ + column);
  }

  double radius_px_;
  int columns_;
  int rows_;
  std::vector<std::vector<cv::Point2f>> buckets_;
};

/// Whether more than kMaxSaturatedShare of the patch is without detail because the sensor ended there.
bool IsSaturated(const cv::Mat& image, const cv::Point& centre) {
  int saturated = 0;
  for (int y = centre.y - corner_strength::kRadiusPx; y <= centre.y + corner_strength::kRadiusPx; ++y) {
    const unsigned char* const row = image.ptr(y) + centre.x;
    saturated +=
        static_cast<int>(std::count_if(row - corner_strength::kRadiusPx, row + corner_strength::kRadiusPx + 1,
                                       [](unsigned char grey) { return grey == 0 || grey >= 254; }));
  }
  constexpr int kSide = 2 * corner_strength::kRadiusPx + 1;
  return saturated > kMaxSaturatedShare * kSide * kSide;
}

void RefineToSubPixels(const cv::Mat& image, std::vector<cv::Point2f>* corners) {
  if (!corners->empty()) {
    const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 10, 0.02);
    cv::cornerSubPix(image, *corners, cv::Size(kSubPixelRadiusPx, kSubPixelRadiusPx), cv::Size(-1, -1),
                     criteria);
  }
}

}  // namespace

CornerGrid::CornerGrid(const FrontendConfig& config, int width_px, int height_px, int border_px)
    : config_(config),
      size_px_(width_px, height_px),
      border_px_(std::max({border_px, corner_strength::kMarginPx,
                           static_cast<int>(config.edge_share * std::min(width_px, height_px))})),
      cells_(config.grid_columns * config.grid_rows),
      rest_(static_cast<size_t>(cells_), 0),
      share_((config.max_features + cells_ - 1) / cells_) {}

int CornerGrid::CellOf(const cv::Point2f& pixel) const {
  const int column = std::clamp(static_cast<int>(pixel.x) * config_.grid_columns / size_px_.width, 0,
                                config_.grid_columns - 1);
  const int row =
      std::clamp(static_cast<int>(pixel.y) * config_.grid_rows / size_px_.height, 0, config_.grid_rows - 1);
  return row * config_.grid_columns + column;
}

cv::Rect CornerGrid::CellRect(int cell) const {
  const int column = cell % config_.grid_columns;
  const int row = cell / config_.grid_columns;
  // Smallest x with x * columns / width == column, as CellOf rounds.
  const auto edge = [](int index, int length, int count) { return (index * length + count - 1) / count; };
  const cv::Point corner(edge(column, size_px_.width, config_.grid_columns),
                         edge(row, size_px_.height, config_.grid_rows));
  const cv::Point end(edge(column + 1, size_px_.width, config_.grid_columns),
                      edge(row + 1, size_px_.height, config_.grid_rows));
  return {corner, end};
}

cv::Rect CornerGrid::Without(int border_px) const {
  return {border_px, border_px, size_px_.width - 2 * border_px, size_px_.height - 2 * border_px};
}

std::vector<bool> CornerGrid::Thin(const std::vector<cv::Point2f>& pixels) const {
  Neighbourhood kept(size_px_, 0.5 * config_.min_distance_px);
  std::vector<bool> keep(pixels.size());
  for (size_t i = 0; i < pixels.size(); ++i) {
    keep[i] = !kept.HasNear(pixels[i]);
    if (keep[i]) {
      kept.Add(pixels[i]);
    }
  }
  return keep;
}

std::vector<Corner> CornerGrid::Propose(const cv::Mat& image, const cv::Mat& derivatives, int cell) const {
  std::vector<Corner> corners =
      corner_strength::Maxima(derivatives, CellRect(cell) & Without(border_px_),
                              corner_strength::OfContrast(config_.corner_threshold));
  corners.erase(std::remove_if(corners.begin(), corners.end(),
                               [&](const Corner& corner) { return IsSaturated(image, corner.pixel); }),
                corners.end());
  return corners;
}

std::vector<int> CornerGrid::CellsToSearch(size_t features) {
  const bool all = 2 * static_cast<int>(features) < config_.max_features;
  std::vector<int> cells;
  for (int cell = 0; cell < cells_; ++cell) {
    int& rest = rest_[static_cast<size_t>(cell)];
    rest = all ? 0 : rest;
    if (rest == 0) {
      cells.push_back(cell);
    } else {
      --rest;
    }
  }
  return cells;
}

float CornerGrid::StrongestOf(const cv::Mat& derivatives, const std::vector<cv::Point2f>& pixels) const {
  const cv::Rect measurable = Without(corner_strength::kMarginPx);
  float strongest = 0;
  for (const cv::Point2f& pixel : pixels) {
    const cv::Point place = pixel;
    if (measurable.contains(place)) {
      strongest = std::max(strongest, corner_strength::At(derivatives, place));
    }
  }
  return strongest;
}

std::vector<cv::Point2f> CornerGrid::Detect(const cv::Mat& image, const cv::Mat& derivatives,
                                            const std::vector<cv::Point2f>& existing) {
  Neighbourhood taken(size_px_, config_.min_distance_px);
  std::vector<int> counts(static_cast<size_t>(cells_), 0);
  for (const cv::Point2f& pixel : existing) {
    taken.Add(pixel);
    ++counts[static_cast<size_t>(CellOf(pixel))];
  }
  // Cells are searched only when their turn comes; a cell that runs dry leaves the round.
  std::vector<std::optional<std::vector<Corner>>> proposals(static_cast<size_t>(cells_));
  std::vector<int> open = CellsToSearch(existing.size());
  float strongest = StrongestOf(derivatives, existing);
  const auto search = [&](size_t cell) {
    if (!proposals[cell].has_value()) {
      proposals[cell] = Propose(image, derivatives, static_cast<int>(cell));
      if (!proposals[cell]->empty()) {
        strongest = std::max(strongest, proposals[cell]->front().strength);
      }
      std::reverse(proposals[cell]->begin(), proposals[cell]->end());
    }
    return &*proposals[cell];
  };
  if (existing.empty()) {
    std::for_each(open.begin(), open.end(), [&](int cell) { search(static_cast<size_t>(cell)); });
  }
  std::vector<cv::Point2f> found;
  while (!open.empty() && static_cast<int>(existing.size() + found.size()) < config_.max_features) {
    const auto emptiest = std::min_element(open.begin(), open.end(), [&](int a, int b) {
      return counts[static_cast<size_t>(a)] < counts[static_cast<size_t>(b)];
    });
    const auto cell = static_cast<size_t>(*emptiest);
    if (counts[cell] >= 2 * share_) {
      open.erase(emptiest);
      continue;
    }
    std::vector<Corner>& queue = *search(cell);
    while (!queue.empty() && taken.HasNear(queue.back().pixel)) {
      queue.pop_back();
    }
    if (queue.empty() || queue.back().strength < kMinRelativeStrength * strongest) {
      rest_[cell] = kRestImages;
      open.erase(emptiest);
      continue;
    }
    taken.Add(queue.back().pixel);
    found.push_back(queue.back().pixel);
    queue.pop_back();
    ++counts[cell];
  }
  RefineToSubPixels(image, &found);
  return found;
}

}  // namespace alidade
