#include "eval/peers/imu_delivery.h"

namespace alidade {

void ImuDelivery::Deliver(const Sample& sample, const Sink& sink) {
  sink(started_ ? sample.time_s - last_.time_s : 0, sample);
  started_ = true;
  last_ = sample;
}

void ImuDelivery::DeliverUntil(double time_s, const Sink& sink) {
  while (!waiting_.empty() && waiting_.front().time_s <= time_s) {
    Deliver(waiting_.front(), sink);
    waiting_.pop_front();
  }
  if (!waiting_.empty() && started_ && last_.time_s < time_s) {
    const Sample& next = waiting_.front();
    const double share = (time_s - last_.time_s) / (next.time_s - last_.time_s);
    Deliver({time_s, (1 - share) * last_.gyro + share * next.gyro,
             (1 - share) * last_.accel + share * next.accel},
            sink);
  }
}

}  // namespace alidade
