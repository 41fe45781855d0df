#pragma once

#include <vector>

#include "core/navigation_state.h"
#include "core/random.h"

namespace alidade::test {

/// Random quantities for property tests; one generator a test, seeded with a literal.
class RandomStates {
 public:
  explicit RandomStates(unsigned seed) : random_(seed, "test states") {}

  double Uniform(double low, double high) { return random_.Uniform(low, high); }
  double Gaussian() { return random_.Normal(); }
  Eigen::Vector3d Vector(double scale) {
    return {Uniform(-scale, scale), Uniform(-scale, scale), Uniform(-scale, scale)};
  }
  Eigen::Matrix3d Rotation() { return so3::Exp(Vector(1.8)); }
  Pose RandomPose(double scale) { return {Rotation(), Vector(scale)}; }
  NavState Nav(double scale) { return {Rotation(), Vector(scale), Vector(2)}; }
  ImuBias Bias() { return {Vector(0.02), Vector(0.2)}; }

  /// `count` cameras within `baseline` of each other that all look at `point`, roughly `distance` away.
  std::vector<Pose> CamerasLookingAt(const Eigen::Vector3d& point, int count, double distance,
                                     double baseline) {
    std::vector<Pose> views;
    const Eigen::Vector3d direction = Vector(1).normalized();
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d center = point - distance * direction + Vector(baseline);
      const Eigen::Vector3d z = (point - center).normalized();
      const Eigen::Vector3d x = z.cross(Eigen::Vector3d(0.3, -0.5, 0.8)).normalized();
      Eigen::Matrix3d rotation;
      rotation << x, z.cross(x), z;
      views.push_back({rotation * so3::Exp(Vector(0.15)), center});
    }
    return views;
  }

 private:
  RandomStream random_;
};

}  // namespace alidade::test
