#pragma once

#include <cstdint>
#include <vector>

namespace alidade {

/// A square grey image that repeats without end, with its mip pyramid: level l is averaged over 2^l x 2^l
/// texels, so that a surface far away shows no aliasing (Williams, "Pyramidal parametrics", 1983).
class Texture {
 public:
  /// texels: row-major, 2^log2_size squared, grey 0 to 255.
  Texture(const std::vector<float>& texels, int log2_size);
  Texture(Texture&&) = default;
  Texture& operator=(Texture&&) = default;
  Texture(const Texture&) = delete;  // levels point into the storage
  Texture& operator=(const Texture&) = delete;
  ~Texture() = default;

  /// Grey at (x, y) in texels of level 0, texel centres at half-integers; linear between the texels of the
  /// level. Levels beyond the last are the last.
  [[nodiscard]] float At(float x, float y, int level) const {
    const Level& mip = levels_[level < last_level_ ? level : last_level_];
    const float scaled_x = x * mip.scale - 0.5F;
    const float scaled_y = y * mip.scale - 0.5F;
    const int column = Floor(scaled_x);
    const int row = Floor(scaled_y);
    const float right = scaled_x - static_cast<float>(column);
    const float down = scaled_y - static_cast<float>(row);
    const std::uint8_t* upper = mip.texels + ((row & mip.mask) << mip.log2_size);
    const std::uint8_t* lower = mip.texels + (((row + 1) & mip.mask) << mip.log2_size);
    const int here = column & mip.mask;
    const int next = (column + 1) & mip.mask;
    const float top = upper[here] + right * static_cast<float>(upper[next] - upper[here]);
    const float bottom = lower[here] + right * static_cast<float>(lower[next] - lower[here]);
    return top + down * (bottom - top);
  }

  [[nodiscard]] int size() const { return 1 << last_level_; }

 private:
  struct Level {
    const std::uint8_t* texels = nullptr;
    float scale = 1;
    int mask = 0;
    int log2_size = 0;
  };

  static int Floor(float value) {
    const int truncated = static_cast<int>(value);
    return truncated - (static_cast<float>(truncated) > value ? 1 : 0);
  }

  std::vector<std::vector<std::uint8_t>> storage_;
  std::vector<Level> levels_;
  int last_level_ = 0;
};

enum class TextureKind {
  kBricks,  ///< a wall: bricks of uneven grey, posters upon it
  kTiles,   ///< a floor: tiles, stains
  kPanels,  ///< a ceiling: large panels, vents
  kLeaves,  ///< opaque shapes of all sizes upon each other
  kMotif,   ///< one motif of 32 x 32 texels again and again
  kPaint,   ///< plain paint, uneven by less than the noise of a sensor
};
inline constexpr int kTextureKinds = 6;

/// A procedural texture; the same for the same seed.
///
/// Shapes upon the ground have radii with density r^-3 ("dead leaves": Lee, Mumford, Huang, "Occlusion models
/// for natural images", 2001), so that at every distance some have the size of a corner detector's patch.
[[nodiscard]] Texture MakeTexture(TextureKind kind, int log2_size, std::uint64_t seed);

}  // namespace alidade
