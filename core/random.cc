#include "core/random.h"

#include <cmath>

namespace alidade {
namespace {

/// FNV-1a over the bytes of a name, 64 bits.
std::uint64_t HashName(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  return hash;
}

/// The output function of SplitMix64 (Steele, Lea, Flood 2014): neighbouring seeds become unrelated.
std::uint64_t Scramble(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view purpose)
    : engine_(Scramble(Scramble(seed) ^ HashName(purpose))) {}

double RandomStream::Uniform() {
  return static_cast<double>(engine_() >> 11) * 0x1p-53;
}

double RandomStream::Normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  double x = 0;
  double y = 0;
  double square = 0;
  do {
    x = 2 * Uniform() - 1;
    y = 2 * Uniform() - 1;
    square = x * x + y * y;
  } while (square >= 1 || square == 0);
  const double scale = std::sqrt(-2 * std::log(square) / square);
  spare_normal_ = y * scale;
  has_spare_ = true;
  return x * scale;
}

Eigen::Vector3d RandomStream::Normal3() {
  // Separate statements: the order of evaluation of constructor arguments is not fixed.
  const double x = Normal();
  const double y = Normal();
  const double z = Normal();
  return {x, y, z};
}

std::uint64_t RandomStream::Below(std::uint64_t bound) {
  // Refuse the top of the range that does not divide evenly.
  const std::uint64_t limit = UINT64_MAX - UINT64_MAX % bound;
  std::uint64_t draw = engine_();
  while (draw >= limit) {
    draw = engine_();
  }
  return draw % bound;
}

}  // namespace alidade
