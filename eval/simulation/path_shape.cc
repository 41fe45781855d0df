#include "eval/simulation/path_shape.h"

#include <cmath>
#include <numbers>

namespace alidade {

double PathShape::PhaseRate(double path_m, double duration_s) const {
  return PhaseAtArcLength(path_m) / duration_s;
}

double PathShape::SpeedOverPhase(double u) const {
  const Jet3 position = Position({u, 1, 0});
  return std::hypot(position[0].first, position[1].first, position[2].first);
}

double PathShape::PhaseAtArcLength(double arc_m) const {
  // An open curve is walked from end to end, in steps that are exact to about 1e-6.
  const int steps = IsClosed() ? 1 << 13 : 1 << 10;
  const double step = 2 * std::numbers::pi / steps;
  double laps = 0;
  double rest_m = arc_m;
  if (IsClosed()) {
    double lap_m = 0;
    for (int i = 0; i < steps; ++i) {
      lap_m += SpeedOverPhase((i + 0.5) * step) * step;
    }
    laps = std::floor(arc_m / lap_m);
    rest_m = arc_m - laps * lap_m;
  }
  for (double i = 0;; ++i) {
    const double step_m = SpeedOverPhase((i + 0.5) * step) * step;
    if (step_m >= rest_m) {
      return 2 * std::numbers::pi * laps + (i + rest_m / step_m) * step;
    }
    rest_m -= step_m;
  }
}

}  // namespace alidade
