#include "eval/simulation/path_wander.h"

#include <numbers>

#include "eval/simulation/path_drift.h"

namespace alidade {
namespace {

/// Sums of sines within a box, x, y and z apart.
class DriftingPoint {
 public:
  DriftingPoint(const SimulatorConfig& config, RandomStream* stream)
      : half_length_m_(0.5 * config.length_m),
        half_width_m_(0.5 * config.width_m),
        height_m_(config.height_m),
        x_(stream),
        y_(stream),
        z_(stream) {}

  [[nodiscard]] Jet3 At(const Jet& u) const {
    return {half_length_m_ * x_.At(u), half_width_m_ * y_.At(u), height_m_ * z_.At(u)};
  }

 private:
  double half_length_m_;
  double half_width_m_;
  double height_m_;
  PathDrift x_;
  PathDrift y_;
  PathDrift z_;
};

/// Looks around: yaw and pitch are sums of sines.
class DriftingView {
 public:
  explicit DriftingView(RandomStream* stream) : yaw_(stream), pitch_(stream) {}

  [[nodiscard]] Jet Yaw(const Jet& u) const { return kYawRange * yaw_.At(u); }
  [[nodiscard]] Jet Pitch(const Jet& u) const { return kPitchRange * pitch_.At(u); }
  /// [1]: d yaw / d u.
  [[nodiscard]] double RmsYawSlope() const { return kYawRange * yaw_.RmsSlope(); }

 private:
  static constexpr double kYawRange = 1.5 * std::numbers::pi;
  static constexpr double kPitchRange = 0.3;

  PathDrift yaw_;
  PathDrift pitch_;
};

/// An aimless walk in a box, looking around.
class Wander final : public PathShape {
 public:
  Wander(const SimulatorConfig& config, RandomStream stream) : point_(config, &stream), view_(&stream) {}

  [[nodiscard]] Jet3 Position(const Jet& u) const override { return point_.At(u); }
  [[nodiscard]] Jet Yaw(const Jet& u) const override { return view_.Yaw(u); }
  [[nodiscard]] Jet Pitch(const Jet& u) const override { return view_.Pitch(u); }
  [[nodiscard]] bool IsClosed() const override { return false; }

 private:
  DriftingPoint point_;
  DriftingView view_;
};

/// The same walk with a level view in one direction.
class Hover final : public PathShape {
 public:
  Hover(const SimulatorConfig& config, RandomStream stream) : point_(config, &stream) {}

  [[nodiscard]] Jet3 Position(const Jet& u) const override { return point_.At(u); }
  [[nodiscard]] Jet Yaw(const Jet&) const override { return {}; }
  [[nodiscard]] Jet Pitch(const Jet&) const override { return {}; }
  [[nodiscard]] bool IsClosed() const override { return false; }

 private:
  DriftingPoint point_;
};

/// Looks around from one point.
class Rotation final : public PathShape {
 public:
  Rotation(const SimulatorConfig& config, RandomStream stream)
      : rate_radps_(config.rotation_rate_radps), view_(&stream) {}

  [[nodiscard]] Jet3 Position(const Jet&) const override { return {}; }
  [[nodiscard]] Jet Yaw(const Jet& u) const override { return view_.Yaw(u); }
  [[nodiscard]] Jet Pitch(const Jet& u) const override { return view_.Pitch(u); }
  [[nodiscard]] bool IsClosed() const override { return false; }
  [[nodiscard]] double PhaseRate(double, double) const override { return rate_radps_ / view_.RmsYawSlope(); }

 private:
  double rate_radps_;
  DriftingView view_;
};

constexpr const char* kStream = "path";

}  // namespace

std::unique_ptr<PathShape> MakeWander(const SimulatorConfig& config, std::uint64_t seed) {
  return std::make_unique<Wander>(config, RandomStream(seed, kStream));
}

std::unique_ptr<PathShape> MakeHover(const SimulatorConfig& config, std::uint64_t seed) {
  return std::make_unique<Hover>(config, RandomStream(seed, kStream));
}

std::unique_ptr<PathShape> MakeRotation(const SimulatorConfig& config, std::uint64_t seed) {
  return std::make_unique<Rotation>(config, RandomStream(seed, kStream));
}

}  // namespace alidade
