#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>

namespace alidade {

/// IMU samples on their way to the solver of VINS-Mono or GVINS: they wait for an image, and the last one
/// before it is followed by one interpolated at it.
class ImuDelivery {
 public:
  struct Sample {
    double time_s = 0;
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
    Eigen::Vector3d accel = Eigen::Vector3d::Zero();
  };
  /// `step_s`: since the sample before; 0 for the first.
  using Sink = std::function<void(double step_s, const Sample& sample)>;

  void Add(const Sample& sample) { waiting_.push_back(sample); }
  /// Delivers what waits up to the time, then a sample at it, if there is one on either side.
  void DeliverUntil(double time_s, const Sink& sink);

 private:
  void Deliver(const Sample& sample, const Sink& sink);

  std::deque<Sample> waiting_;
  bool started_ = false;
  Sample last_;  ///< delivered last
};

}  // namespace alidade
