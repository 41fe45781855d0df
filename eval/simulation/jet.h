#pragma once

#include <array>
#include <cmath>

namespace alidade {

/// A function of one variable with its first and second derivative; the arithmetic below is the chain rule.
struct Jet {
  double value = 0;
  double first = 0;
  double second = 0;
};

using Jet3 = std::array<Jet, 3>;

inline Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.first + b.first, a.second + b.second};
}
inline Jet operator*(double s, const Jet& a) {
  return {s * a.value, s * a.first, s * a.second};
}

inline Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.first * b.value + a.value * b.first,
          a.second * b.value + 2 * a.first * b.first + a.value * b.second};
}
/// f(x) of a function f that is given at x.value.
inline Jet Compose(const Jet& f, const Jet& x) {
  return {f.value, f.first * x.first, f.second * x.first * x.first + f.first * x.second};
}

inline Jet Sin(const Jet& a) {
  const double s = std::sin(a.value);
  const double c = std::cos(a.value);
  return {s, c * a.first, c * a.second - s * a.first * a.first};
}

inline Jet Cos(const Jet& a) {
  const double s = std::sin(a.value);
  const double c = std::cos(a.value);
  return {c, -s * a.first, -s * a.second - c * a.first * a.first};
}

/// sqrt(x^2 + y^2), not both zero.
inline Jet Hypot(const Jet& x, const Jet& y) {
  const double r = std::hypot(x.value, y.value);
  const double first = (x.value * x.first + y.value * y.first) / r;
  const double second =
      (x.first * x.first + y.first * y.first + x.value * x.second + y.value * y.second - first * first) / r;
  return {r, first, second};
}

/// atan2(y, x), not both zero.
inline Jet Atan2(const Jet& y, const Jet& x) {
  const double square = x.value * x.value + y.value * y.value;
  const double first = (x.value * y.first - y.value * x.first) / square;
  const double second =
      (x.value * y.second - y.value * x.second - 2 * (x.value * x.first + y.value * y.first) * first) /
      square;
  return {std::atan2(y.value, x.value), first, second};
}

}  // namespace alidade
