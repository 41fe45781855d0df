#pragma once

#include <Eigen/Core>

#include "core/time.h"
#include "eval/files/byte_io.h"

namespace alidade {

/// A ROS time of a message: seconds, then nanoseconds, 32 bits each.
inline void PutRosTime(TimeNs stamp_ns, ByteWriter* out) {
  out->Write(static_cast<std::uint32_t>(stamp_ns / kSecondNs));
  out->Write(static_cast<std::uint32_t>(stamp_ns % kSecondNs));
}

[[nodiscard]] inline TimeNs TakeRosTime(ByteReader* in) {
  const TimeNs seconds = in->Read<std::uint32_t>();
  return seconds * kSecondNs + in->Read<std::uint32_t>();
}

/// std_msgs/Header; its sequence number and frame are not used.
inline void PutRosHeader(TimeNs stamp_ns, ByteWriter* out) {
  out->Write(std::uint32_t{0});
  PutRosTime(stamp_ns, out);
  out->Block("");
}

[[nodiscard]] inline TimeNs TakeRosHeader(ByteReader* in) {
  static_cast<void>(in->Read<std::uint32_t>());
  const TimeNs stamp_ns = TakeRosTime(in);
  static_cast<void>(in->Block());
  return stamp_ns;
}

/// geometry_msgs/Vector3
inline void PutRosVector(const Eigen::Vector3d& vector, ByteWriter* out) {
  for (int i = 0; i < 3; ++i) {
    out->Write(vector[i]);
  }
}

[[nodiscard]] inline Eigen::Vector3d TakeRosVector(ByteReader* in) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    vector[i] = in->Read<double>();
  }
  return vector;
}

}  // namespace alidade
