#include "frontend/tracking/corner_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace alidade {
namespace {

// FAST looks 3 px around a pixel, and one more for the suppression of non-maxima.
constexpr int kFastMarginPx = 4;
// FAST corners of one cell whose structure tensor is worth computing, strongest first.
constexpr size_t kMaxProposals = 40;
constexpr int kTensorRadiusPx = 3;
constexpr int kSubPixelRadiusPx = 3;
// Corners below this share of the cell's best are edges or noise beside it.
constexpr float kMinRelativeEigenvalue = 0.02F;

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

/// Smaller eigenvalue of the structure tensor around an integer pixel, in squared derivative units.
float SmallerEigenvalue(const cv::Mat& derivatives, const cv::Point& centre) {
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (int row = centre.y - kTensorRadiusPx; row <= centre.y + kTensorRadiusPx; ++row) {
    const cv::Vec2s* line = derivatives.ptr<cv::Vec2s>(row);
    for (int column = centre.x - kTensorRadiusPx; column <= centre.x + kTensorRadiusPx; ++column) {
      const double dx = line[column][0];
      const double dy = line[column][1];
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  return static_cast<float>(0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy)));
}

struct Proposal {
  cv::Point2f pixel;
  float strength = 0;
};

/// Strongest first; equal strengths in reading order, so that the order never depends on the sort.
bool Before(const Proposal& a, const Proposal& b) {
  if (a.strength != b.strength) {
    return a.strength > b.strength;
  }
  return a.pixel.y != b.pixel.y ? a.pixel.y < b.pixel.y : a.pixel.x < b.pixel.x;
}

}  // namespace

CornerGrid::CornerGrid(const FrontendConfig& config, int width_px, int height_px, int border_px)
    : config_(config),
      size_px_(width_px, height_px),
      border_px_(std::max(border_px, kTensorRadiusPx + 1)),
      cells_(config.grid_columns * config.grid_rows),
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

std::vector<bool> CornerGrid::Thin(const std::vector<cv::Point2f>& pixels) const {
  Neighbourhood kept(size_px_, 0.5 * config_.min_distance_px);
  std::vector<int> counts(static_cast<size_t>(cells_), 0);
  std::vector<bool> keep(pixels.size());
  for (size_t i = 0; i < pixels.size(); ++i) {
    int& count = counts[static_cast<size_t>(CellOf(pixels[i]))];
    keep[i] = count < 2 * share_ && !kept.HasNear(pixels[i]);
    if (keep[i]) {
      kept.Add(pixels[i]);
      ++count;
    }
  }
  return keep;
}

std::vector<cv::Point2f> CornerGrid::Propose(const cv::Mat& image, const cv::Mat& derivatives,
                                             int cell) const {
  const cv::Rect allowed(border_px_, border_px_, size_px_.width - 2 * border_px_,
                         size_px_.height - 2 * border_px_);
  const cv::Rect cell_rect = CellRect(cell) & allowed;
  if (cell_rect.empty()) {
    return {};
  }
  const cv::Rect search =
      cv::Rect(cell_rect.x - kFastMarginPx, cell_rect.y - kFastMarginPx, cell_rect.width + 2 * kFastMarginPx,
               cell_rect.height + 2 * kFastMarginPx) &
      cv::Rect({0, 0}, size_px_);
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image(search), corners, static_cast<int>(std::lround(config_.corner_threshold)), true);
  std::vector<Proposal> proposals;
  for (const cv::KeyPoint& corner : corners) {
    const cv::Point2f pixel = corner.pt + cv::Point2f(search.tl());
    if (cell_rect.contains(pixel)) {
      proposals.push_back({pixel, corner.response});
    }
  }
  std::sort(proposals.begin(), proposals.end(), Before);
  proposals.resize(std::min(proposals.size(), kMaxProposals));
  for (Proposal& proposal : proposals) {
    proposal.strength = SmallerEigenvalue(derivatives, proposal.pixel);
  }
  std::sort(proposals.begin(), proposals.end(), Before);
  std::vector<cv::Point2f> pixels;
  for (const Proposal& proposal : proposals) {
    if (proposal.strength < kMinRelativeEigenvalue * proposals.front().strength) {
      break;
    }
    pixels.push_back(proposal.pixel);
  }
  return pixels;
}

std::vector<cv::Point2f> CornerGrid::Detect(const cv::Mat& image, const cv::Mat& derivatives,
                                            const std::vector<cv::Point2f>& existing) const {
  Neighbourhood taken(size_px_, config_.min_distance_px);
  std::vector<int> counts(static_cast<size_t>(cells_), 0);
  for (const cv::Point2f& pixel : existing) {
    taken.Add(pixel);
    ++counts[static_cast<size_t>(CellOf(pixel))];
  }
  // Cells are searched only when their turn comes; a cell that runs dry leaves the round.
  std::vector<std::optional<std::vector<cv::Point2f>>> proposals(static_cast<size_t>(cells_));
  std::vector<int> open(static_cast<size_t>(cells_));
  std::iota(open.begin(), open.end(), 0);
  std::vector<cv::Point2f> found;
  while (!open.empty() && static_cast<int>(existing.size() + found.size()) < config_.max_features) {
    const auto emptiest = std::min_element(open.begin(), open.end(), [&](int a, int b) {
      return counts[static_cast<size_t>(a)] < counts[static_cast<size_t>(b)];
    });
    const size_t cell = static_cast<size_t>(*emptiest);
    if (!proposals[cell].has_value()) {
      proposals[cell] = Propose(image, derivatives, *emptiest);
      std::reverse(proposals[cell]->begin(), proposals[cell]->end());
    }
    std::vector<cv::Point2f>& queue = *proposals[cell];
    while (!queue.empty() && taken.HasNear(queue.back())) {
      queue.pop_back();
    }
    if (queue.empty() || counts[cell] >= 2 * share_) {
      open.erase(emptiest);
      continue;
    }
    taken.Add(queue.back());
    found.push_back(queue.back());
    queue.pop_back();
    ++counts[cell];
  }
  if (!found.empty()) {
    const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 10, 0.02);
    cv::cornerSubPix(image, found, cv::Size(kSubPixelRadiusPx, kSubPixelRadiusPx), cv::Size(-1, -1),
                     criteria);
  }
  return found;
}

}  // namespace alidade
