#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

namespace alidade {

/// A stream of pseudo-random numbers that is the same on every standard library: the engine is
/// std::mt19937_64, whose output the C++ standard specifies; the distributions, which it does not specify,
/// are implemented here.
///
/// A stream is named by a seed and a purpose. Streams of different purposes are practically independent: an
/// additional sensor or draw in one stream does not change the numbers of the others.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view purpose);

  /// Uniform in [0, 1), 53 random bits.
  double Uniform();
  /// Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Standard normal; Marsaglia's polar method (Marsaglia and Bray, 1964).
  double Normal();
  /// Three independent standard normals, drawn x, y, z.
  Eigen::Vector3d Normal3();
  /// True with the given probability. Always draws once.
  bool Chance(double probability) { return Uniform() < probability; }
  /// Uniform in {0, .., bound - 1}, bound >= 1; without modulo bias.
  std::uint64_t Below(std::uint64_t bound);

  /// Fisher-Yates; every order is equally likely.
  template <typename T>
  void Shuffle(std::vector<T>* values) {
    for (std::size_t i = values->size(); i > 1; --i) {
      std::swap((*values)[i - 1], (*values)[static_cast<std::size_t>(Below(i))]);
    }
  }

 private:
  std::mt19937_64 engine_;
  double spare_normal_ = 0;
  bool has_spare_ = false;
};

}  // namespace alidade
