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

/// The covariance of the translation in one of a pose (x, y, z, three angles).
std::optional<Eigen::Matrix3d> TakePoseCovariance(ByteReader* in) {
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> of_pose;
  for (int i = 0; i < 36; ++i) {
    of_pose(i / 6, i % 6) = in->Read<double>();
  }
  const Eigen::Matrix3d of_position = of_pose.topLeftCorner<3, 3>();
  const Eigen::Matrix3d symmetric = 0.5 * (of_position + of_position.transpose());
  return symmetric.allFinite() && IsPositiveDefinite(symmetric) ? std::optional(symmetric) : std::nullopt;
}

/// What follows the header in a message of a local position.
struct LocalLayout {
  bool has_child_frame;
  bool has_rotation;
  bool has_covariance;
  int further_numbers;  ///< behind the covariance
};

LocalLayout LayoutOf(std::string_view type) {
  if (type == "nav_msgs/Odometry") {
    return {true, true, true, 6 + 36};  // twist and its covariance
  }
  const bool has_covariance = type == "geometry_msgs/PoseWithCovarianceStamped";
  return {type == "geometry_msgs/TransformStamped", type != "geometry_msgs/PointStamped", has_covariance, 0};
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

const std::vector<std::string>& LocalPositionTypes() {
  static const std::vector<std::string> types = {
      "geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped",
      "geometry_msgs/TransformStamped", "geometry_msgs/PointStamped", "nav_msgs/Odometry"};
  return types;
}

bool LocalPositionHasCovariance(std::string_view type) {
  return LayoutOf(type).has_covariance;
}

std::optional<LocalPosition> DecodeLocalPosition(std::string_view type, std::string_view bytes) {
  const LocalLayout layout = LayoutOf(type);
  ByteReader in(bytes);
  LocalPosition position;
  position.stamp_ns = TakeRosHeader(&in);
  if (layout.has_child_frame) {
    static_cast<void>(in.Block());
  }
  position.p_A = TakeRosVector(&in);
  if (layout.has_rotation) {
    static_cast<void>(in.Take(4 * sizeof(double)));
  }
  if (layout.has_covariance) {
    position.covariance = TakePoseCovariance(&in);
  }
  static_cast<void>(in.Take(static_cast<std::size_t>(layout.further_numbers) * sizeof(double)));
  return in.ok() && position.p_A.allFinite() ? std::optional(position) : std::nullopt;
}

}  // namespace alidade
