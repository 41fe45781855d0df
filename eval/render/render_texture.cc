#include "eval/render/render_texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/random.h"

namespace alidade {
namespace {

constexpr float kSmallestShape = 3;     // texels, half-extent
constexpr float kLargestShape = 0.07F;  // of the texture's side
constexpr int kLog2Motif = 5;

/// A canvas without edges: what leaves at one side comes in at the other.
class Canvas {
 public:
  Canvas(int log2_size, std::uint64_t seed, TextureKind kind)
      : log2_size_(log2_size),
        size_(1 << log2_size),
        stream_(seed, "render.texture." + std::to_string(static_cast<int>(kind))),
        grey_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {}

  /// Rectangles of uneven grey with dark joints; every second row shifted by `shift` of a width. The cells
  /// divide the texture.
  void Cells(int columns, int rows, float shift, float low, float high) {
    const float width = static_cast<float>(size_) / static_cast<float>(columns);
    const float height = static_cast<float>(size_) / static_cast<float>(rows);
    std::vector<float> greys(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (float& grey : greys) {
      grey = Uniform(low, high);
    }
    for (int y = 0; y < size_; ++y) {
      const int row = static_cast<int>(static_cast<float>(y) / height);
      const float within_y = static_cast<float>(y) - static_cast<float>(row) * height;
      for (int x = 0; x < size_; ++x) {
        const float along = static_cast<float>(x) / width + (row % 2 == 0 ? 0 : shift);
        const int column = static_cast<int>(along);
        const float within_x = (along - static_cast<float>(column)) * width;
        const bool joint = within_x < 2 || within_y < 2;
        const float cell = greys[static_cast<std::size_t>(row * columns + column % columns)];
        At(x, y) = joint ? 0.5F * low : cell;
      }
    }
  }

  void Fill(float grey) { std::fill(grey_.begin(), grey_.end(), grey); }

  /// Opaque shapes, in all about `coverage` times the canvas.
  void Leaves(float coverage) {
    const float largest = kLargestShape * static_cast<float>(size_);
    double left = static_cast<double>(coverage) * size_ * size_;
    while (left > 0) {
      // Inverse of the cumulative distribution of r^-3 between the two bounds.
      const float a = 1 / (kSmallestShape * kSmallestShape);
      const float b = 1 / (largest * largest);
      const float radius = 1 / std::sqrt(a - Uniform(0, 1) * (a - b));
      left -= 3.0 * radius * radius;
      Leaf(radius);
    }
  }

  /// Rough at every scale: noise of knots 64, 32, ... 2 texels apart with amplitudes that fall with the
  /// distance's root.
  void Roughen(float amplitude) {
    float share = 0.5F;
    for (int knot = 64; knot >= 2; knot /= 2, share *= 0.75F) {
      AddNoise(std::min(knot, size_), share * amplitude);
    }
  }

  /// Covers the canvas with copies of its first square of 2^log2_side texels.
  void Repeat(int log2_side) {
    const int mask = (1 << log2_side) - 1;
    for (int y = 0; y < size_; ++y) {
      for (int x = 0; x < size_; ++x) {
        At(x, y) = At(x & mask, y & mask);
      }
    }
  }

  [[nodiscard]] Texture Finish() {
    for (float& grey : grey_) {
      grey = std::clamp(grey, 0.0F, 255.0F);
    }
    return {grey_, log2_size_};
  }

 private:
  float& At(int x, int y) {
    const int mask = size_ - 1;
    return grey_[static_cast<std::size_t>(((y & mask) << log2_size_) + (x & mask))];
  }

  float Uniform(float low, float high) {
    return static_cast<float>(stream_.Uniform(static_cast<double>(low), static_cast<double>(high)));
  }

  /// One shape: a disc or a turned rectangle, its edge one texel soft.
  void Leaf(float radius) {
    const float centre_x = Uniform(0, static_cast<float>(size_));
    const float centre_y = Uniform(0, static_cast<float>(size_));
    const bool disc = stream_.Chance(0.25);
    const float angle = Uniform(0, 2 * std::numbers::pi_v<float>);
    const float flat = Uniform(0.4F, 1);
    const float grey = Uniform(25, 230);
    const float cosine = std::cos(angle);
    const float sine = std::sin(angle);
    const int reach = static_cast<int>(std::ceil(1.5F * radius)) + 1;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int x = static_cast<int>(centre_x) + dx;
        const int y = static_cast<int>(centre_y) + dy;
        const float off_x = static_cast<float>(x) + 0.5F - centre_x;
        const float off_y = static_cast<float>(y) + 0.5F - centre_y;
        const float along = cosine * off_x + sine * off_y;
        const float across = cosine * off_y - sine * off_x;
        const float outside = disc ? std::hypot(off_x, off_y) - radius
                                   : std::max(std::abs(along) - radius, std::abs(across) - flat * radius);
        const float cover = std::clamp(0.5F - outside, 0.0F, 1.0F);
        float& pixel = At(x, y);
        pixel += cover * (grey - pixel);
      }
    }
  }

  void AddNoise(int knot, float amplitude) {
    const int knots = size_ / knot;
    std::vector<float> values(static_cast<std::size_t>(knots) * static_cast<std::size_t>(knots));
    for (float& value : values) {
      value = Uniform(-amplitude, amplitude);
    }
    const auto value_at = [&](int i, int j) {
      return values[static_cast<std::size_t>((j % knots) * knots + i % knots)];
    };
    for (int y = 0; y < size_; ++y) {
      const int j = y / knot;
      const float v = static_cast<float>(y % knot) / static_cast<float>(knot);
      for (int x = 0; x < size_; ++x) {
        const int i = x / knot;
        const float u = static_cast<float>(x % knot) / static_cast<float>(knot);
        At(x, y) += (1 - v) * ((1 - u) * value_at(i, j) + u * value_at(i + 1, j)) +
                    v * ((1 - u) * value_at(i, j + 1) + u * value_at(i + 1, j + 1));
      }
    }
  }

  int log2_size_;
  int size_;
  RandomStream stream_;
  std::vector<float> grey_;
};

}  // namespace

Texture::Texture(const std::vector<float>& texels, int log2_size) : last_level_(log2_size) {
  std::vector<float> level = texels;
  for (int l = 0; l <= log2_size; ++l) {
    const auto size = std::size_t{1} << (log2_size - l);
    std::vector<std::uint8_t> rounded(size * size);
    std::transform(level.begin(), level.end(), rounded.begin(),
                   // Not negative, so truncation rounds.
                   // NOLINTNEXTLINE(bugprone-incorrect-roundings)
                   [](float grey) { return static_cast<std::uint8_t>(grey + 0.5F); });
    storage_.push_back(std::move(rounded));
    const auto mask = static_cast<int>(size) - 1;
    levels_.push_back(
        {storage_.back().data(), 1 / static_cast<float>(std::size_t{1} << l), mask, log2_size - l});
    const std::size_t half = size / 2;
    std::vector<float> coarser(half * half);
    for (std::size_t y = 0; y < half; ++y) {
      for (std::size_t x = 0; x < half; ++x) {
        const std::size_t at = 2 * y * size + 2 * x;
        coarser[y * half + x] = 0.25F * (level[at] + level[at + 1] + level[at + size] + level[at + size + 1]);
      }
    }
    level = std::move(coarser);
  }
}

Texture MakeTexture(TextureKind kind, int log2_size, std::uint64_t seed) {
  Canvas canvas(log2_size, seed, kind);
  switch (kind) {
    case TextureKind::kBricks:
      canvas.Cells(32, 64, 0.5F, 90, 160);
      canvas.Leaves(0.25F);
      canvas.Roughen(30);
      break;
    case TextureKind::kTiles:
      canvas.Cells(16, 16, 0, 70, 130);
      canvas.Leaves(0.12F);
      canvas.Roughen(40);
      break;
    case TextureKind::kPanels:
      canvas.Cells(8, 16, 0.5F, 120, 170);
      canvas.Leaves(0.12F);
      canvas.Roughen(30);
      break;
    case TextureKind::kLeaves:
      canvas.Fill(120);
      canvas.Leaves(1.5F);
      canvas.Roughen(20);
      break;
    case TextureKind::kMotif:
      canvas.Fill(120);
      canvas.Leaves(1.5F);
      canvas.Repeat(std::min(log2_size, kLog2Motif));
      break;
    case TextureKind::kPaint:
      canvas.Fill(150);
      canvas.Roughen(3);
      break;
  }
  return canvas.Finish();
}

}  // namespace alidade
