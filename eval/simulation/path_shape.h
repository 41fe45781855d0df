#pragma once

#include "eval/simulation/jet.h"

namespace alidade {

/// The curve of an analytic trajectory over its phase u [rad], without the notion of time.
class PathShape {
 public:
  virtual ~PathShape() = default;

  /// Position in W [m] at the phase, which may itself be a function.
  [[nodiscard]] virtual Jet3 Position(const Jet& u) const = 0;
  /// Where the body's x axis points [rad], before any wobble: R_WB = Rz(yaw) Ry(pitch).
  [[nodiscard]] virtual Jet Yaw(const Jet& u) const = 0;
  [[nodiscard]] virtual Jet Pitch(const Jet& u) const = 0;
  /// Whether the curve closes after 2 pi.
  [[nodiscard]] virtual bool IsClosed() const = 0;

  /// d u / d tau [rad/s] at which `path_m` are travelled in `duration_s`.
  [[nodiscard]] virtual double PhaseRate(double path_m, double duration_s) const;

 private:
  /// The phase at which the path from phase 0 is `arc_m` long. The midpoint rule converges spectrally over
  /// whole laps of a closed curve; what is left is walked in steps, exact to about 1e-7 of a lap (an open
  /// curve: 1e-6 of the path).
  [[nodiscard]] double PhaseAtArcLength(double arc_m) const;
  /// |d Position / d u| [m/rad].
  [[nodiscard]] double SpeedOverPhase(double u) const;
};

}  // namespace alidade
