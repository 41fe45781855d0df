#include "eval/rosbag/ros_position_messages.h"

#include <cmath>

#include "core/dense_solvers.h"
#include "eval/rosbag/ros_header.h"

namespace alidade {
namespace {

// sensor_msgs/NavSatStatus
constexpr std::int8_t kNoFix = -1;
constexpr std::int8_t kSbas = 1;
constexpr std::int8_t kGbas = 2;
// NavSatFix::position_covariance_type
constexpr std::uint8_t kUnknown = 0;
constexpr std::uint8_t kKnown = 3;

void PutMatrix(const Eigen::Matrix3d& matrix, ByteWriter* out) {
  for (int i = 0; i < 9; ++i) {
    out->Write(matrix(i / 3, i % 3));
  }
}

Eigen::Matrix3d TakeMatrix(ByteReader* in) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) {
    matrix(i / 3, i % 3) = in->Read<double>();
  }
  return matrix;
}

Eigen::Matrix3d UsualCovariance(std::int8_t status) {
  const double deviation = status == kGbas ? 0.5 : status == kSbas ? 1 : 3;
  return Eigen::Vector3d(deviation, deviation, 2 * deviation).cwiseAbs2().asDiagonal();
}

}  // namespace

std::string EncodeNavSatFix(const NavSatFix& fix) {
  ByteWriter out;
  PutRosHeader(fix.stamp_ns, &out);
  out.Write(std::int8_t{0});
  out.Write(std::uint16_t{1});  // GPS
  PutRosVector(fix.llh_deg, &out);
  PutMatrix(fix.covariance_N, &out);
  out.Write(kKnown);
  return std::move(out.bytes());
}

DecodedNavSatFix DecodeNavSatFix(std::string_view bytes) {
  ByteReader in(bytes);
  NavSatFix fix;
  fix.stamp_ns = TakeRosHeader(&in);
  const auto status = in.Read<std::int8_t>();
  static_cast<void>(in.Read<std::uint16_t>());
  fix.llh_deg = TakeRosVector(&in);
  fix.covariance_N = TakeMatrix(&in);
  const auto type = in.Read<std::uint8_t>();
  if (!in.ok() || type > kKnown) {
    return {};
  }
  if (status <= kNoFix || !fix.llh_deg.allFinite()) {
    return {true, std::nullopt};
  }
  constexpr double kHighestM = 1e5;
  if (std::abs(fix.llh_deg[0]) > 90 || std::abs(fix.llh_deg[1]) > 360 ||
      std::abs(fix.llh_deg[2]) > kHighestM) {
    return {};
  }
  if (type == kUnknown) {
    fix.covariance_N = UsualCovariance(status);
  } else if (type != kKnown) {
    fix.covariance_N = Eigen::Matrix3d(fix.covariance_N.diagonal().asDiagonal());
  }
  fix.covariance_N = (0.5 * (fix.covariance_N + fix.covariance_N.transpose())).eval();
  if (!fix.covariance_N.allFinite() || !IsPositiveDefinite(fix.covariance_N)) {
    return {};
  }
  return {true, fix};
}

std::string EncodePosition(const PositionFix& fix) {
  ByteWriter out;
  PutRosHeader(fix.stamp_ns, &out);
  PutRosVector(fix.p_A, &out);
  PutMatrix(fix.covariance, &out);
  return std::move(out.bytes());
}

std::optional<PositionFix> DecodePosition(std::string_view bytes) {
  ByteReader in(bytes);
  PositionFix fix;
  fix.stamp_ns = TakeRosHeader(&in);
  fix.p_A = TakeRosVector(&in);
  fix.covariance = TakeMatrix(&in);
  const bool fine = in.ok() && fix.p_A.allFinite() && fix.covariance.allFinite() &&
                    fix.covariance == fix.covariance.transpose() && IsPositiveDefinite(fix.covariance);
  return fine ? std::optional(fix) : std::nullopt;
}

}  // namespace alidade
