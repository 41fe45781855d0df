#include "eval/simulation/path_drift.h"

#include <cmath>
#include <numbers>

namespace alidade {
namespace {

constexpr std::array<double, 4> kAmplitude = {0.4, 0.3, 0.2, 0.1};
constexpr std::array<double, 4> kFrequency = {0.5, 0.866, 1.414, 2.236};

}  // namespace

PathDrift::PathDrift(RandomStream* stream) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    // Frequencies incommensurate by themselves; the jitter keeps the axes, and the seeds, from marching
    // together.
    frequency_[i] = kFrequency[i] * stream->Uniform(0.9, 1.1);
    offset_[i] = stream->Uniform(0, 2 * std::numbers::pi);
  }
}

Jet PathDrift::At(const Jet& u) const {
  Jet sum;
  for (std::size_t i = 0; i < kTerms; ++i) {
    sum = sum + kAmplitude[i] * Sin(frequency_[i] * u + Jet{offset_[i], 0, 0});
  }
  return sum;
}

double PathDrift::RmsSlope() const {
  double squares = 0;
  for (std::size_t i = 0; i < kTerms; ++i) {
    squares += 0.5 * std::pow(kAmplitude[i] * frequency_[i], 2);
  }
  return std::sqrt(squares);
}

}  // namespace alidade
