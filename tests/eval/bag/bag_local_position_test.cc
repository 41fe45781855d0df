#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "eval/bag/bag_import.h"
#include "eval/rosbag/ros_header.h"
#include "eval/rosbag/ros_position_messages.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/rosbag/rosbag_writer.h"
#include "tests/support/temporary_folder.h"

// Positions of motion capture and UWB in bags of other programs.

namespace alidade {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr TimeNs kStart = 1'700'000'000'000'000'000;
constexpr const char* kTopic = "/vrpn/robot";

/// A message type of ROS, and what it holds between its header and its end.
struct MessageType {
  const char* name;
  bool has_child_frame;
  bool has_rotation;
  bool has_covariance;
  bool has_twist;
};

std::ostream& operator<<(std::ostream& stream, const MessageType& type) {
  return stream << type.name;
}

/// A message of this type, field by field as ROS defines it; the covariance of its position is the diagonal
/// of `variances`.
std::string Message(const MessageType& type, TimeNs stamp_ns, const Vector3d& position,
                    const Vector3d& variances) {
  ByteWriter out;
  PutRosHeader(stamp_ns, &out);
  if (type.has_child_frame) {
    out.Block("robot");
  }
  PutRosVector(position, &out);
  if (type.has_rotation) {
    PutRosVector(Vector3d(0.6, 0, 0), &out);
    out.Write(0.8);
  }
  for (int i = 0; type.has_covariance && i < 36; ++i) {
    out.Write(i % 7 != 0 ? 0.0 : i / 7 < 3 ? variances[i / 7] : 0.5);
  }
  for (int i = 0; type.has_twist && i < 6 + 36; ++i) {
    out.Write(0.25 * i);
  }
  return out.bytes();
}

class BagLocalPosition : public testing::TestWithParam<MessageType> {
 protected:
  static constexpr int kMessages = 5;

  /// A bag with IMU samples and positions on kTopic.
  std::string Recorded(const Vector3d& variances) const {
    std::string path = folder_.File("capture.bag");
    Result<RosbagWriter> bag = RosbagWriter::Create(path, BagCompression::kNone);
    EXPECT_TRUE(bag.ok()) << bag.message();
    const std::uint32_t imu = bag->AddTopic("/imu0", "sensor_msgs/Imu");
    const std::uint32_t positions = bag->AddTopic(kTopic, GetParam().name);
    for (int i = 0; i < kMessages; ++i) {
      ImuSample sample;
      sample.stamp_ns = kStart + i * TimeNs{10'000'000};
      EXPECT_TRUE(bag->Write(imu, sample.stamp_ns, EncodeImu(sample)).ok());
      const std::string message = Message(GetParam(), sample.stamp_ns + 7, Vector3d(i, 2, -0.5), variances);
      EXPECT_TRUE(bag->Write(positions, sample.stamp_ns, message).ok());
    }
    EXPECT_TRUE(bag->Close().ok());
    return path;
  }

  static Result<BagImport> Read(const std::string& path, const std::string& topics) {
    BagImportOptions options;
    options.imu = ImuSensor();
    options.topics = topics;
    return ReadBag(path, options);
  }

  static void ExpectPositions(const Result<BagImport>& import, const Vector3d& variances) {
    ASSERT_TRUE(import.ok()) << import.message();
    const Dataset& dataset = import->dataset;
    ASSERT_EQ(dataset.rig.fixes.size(), 1u);
    EXPECT_FALSE(dataset.rig.fixes[0].anchor_llh_deg.has_value());
    ASSERT_EQ(dataset.fixes.size(), static_cast<std::size_t>(kMessages));
    for (int i = 0; i < kMessages; ++i) {
      const PositionFix& fix = dataset.fixes[static_cast<std::size_t>(i)];
      EXPECT_EQ(fix.stamp_ns, kStart + i * TimeNs{10'000'000} + 7);
      EXPECT_EQ(fix.sensor, 0);
      EXPECT_EQ(fix.p_A, Vector3d(i, 2, -0.5));
      EXPECT_TRUE(fix.covariance.isApprox(Eigen::Matrix3d(variances.asDiagonal()))) << fix.covariance;
    }
  }

  test::TemporaryFolder folder_;
};

TEST_P(BagLocalPosition, GIVEN_a_deviation_THEN_it_is_that_of_positions_whose_message_has_none) {
  const Vector3d variances(0.01, 0.04, 0.09);
  const std::string path = Recorded(variances);
  ExpectPositions(Read(path, "fix=/vrpn/robot,fix_std_m=0.5"),
                  GetParam().has_covariance ? variances : Vector3d::Constant(0.25));
}

TEST_P(BagLocalPosition, GIVEN_no_deviation_THEN_a_message_without_a_covariance_is_refused) {
  const Vector3d variances(0.01, 0.04, 0.09);
  const Result<BagImport> import = Read(Recorded(variances), "fix=/vrpn/robot");
  if (GetParam().has_covariance) {
    ExpectPositions(import, variances);
  } else {
    EXPECT_EQ(import.code(), StatusCode::kInput);
    EXPECT_THAT(import.message(), HasSubstr("/vrpn/robot (" + std::string(GetParam().name) + ")"));
    EXPECT_THAT(import.message(), HasSubstr("fix_std_m=METRES"));
  }
}

TEST_P(BagLocalPosition, GIVEN_a_covariance_of_zeros_THEN_it_counts_as_none) {
  const std::string path = Recorded(Vector3d::Zero());
  const Result<BagImport> import = Read(path, "fix=/vrpn/robot");
  EXPECT_EQ(import.code(), StatusCode::kInput);
  EXPECT_THAT(import.message(), HasSubstr(GetParam().has_covariance ? "without a positive definite covariance"
                                                                    : "without a covariance"));
  ExpectPositions(Read(path, "fix=/vrpn/robot,fix_std_m=0.01"), Vector3d::Constant(1e-4));
}

TEST_P(BagLocalPosition, GIVEN_a_topic_that_is_not_named_THEN_it_is_not_used) {
  const Result<BagImport> import = Read(Recorded(Vector3d::Ones()), "");
  ASSERT_TRUE(import.ok()) << import.message();
  EXPECT_THAT(import->dataset.fixes, IsEmpty());
  EXPECT_THAT(import->dataset.rig.fixes, IsEmpty());
}

TEST_P(BagLocalPosition, GIVEN_a_deviation_that_is_no_length_THEN_it_is_named) {
  // Positions with a covariance do not need it; a wrong one is refused all the same.
  const std::string path = Recorded(Vector3d::Ones());
  for (const char* text : {"0", "-1", "nan", "inf", "1cm", "0.01x", "abc"}) {
    const Result<BagImport> import = Read(path, std::string("fix=/vrpn/robot,fix_std_m=") + text);
    EXPECT_EQ(import.code(), StatusCode::kUsage) << text;
    EXPECT_THAT(import.message(), HasSubstr("fix_std_m: found '" + std::string(text) + "'"));
  }
}

TEST_P(BagLocalPosition, GIVEN_a_deviation_without_the_topic_THEN_it_is_refused) {
  const Result<BagImport> import = Read(Recorded(Vector3d::Ones()), "fix_std_m=0.01");
  EXPECT_EQ(import.code(), StatusCode::kUsage);
  EXPECT_THAT(import.message(), HasSubstr("expected fix=TOPIC"));
}

TEST_P(BagLocalPosition, GIVEN_torn_bytes_THEN_nothing_is_decoded) {
  const std::string message = Message(GetParam(), kStart, Vector3d(1, 2, 3), Vector3d::Ones());
  ASSERT_TRUE(DecodeLocalPosition(GetParam().name, message).has_value());
  for (std::size_t size = 0; size < message.size(); ++size) {
    ASSERT_FALSE(DecodeLocalPosition(GetParam().name, message.substr(0, size)).has_value()) << size;
  }
  const std::string not_finite = Message(GetParam(), kStart, Vector3d(NAN, 2, 3), Vector3d::Ones());
  EXPECT_FALSE(DecodeLocalPosition(GetParam().name, not_finite).has_value());
}

INSTANTIATE_TEST_SUITE_P(
    Types, BagLocalPosition,
    testing::Values(MessageType{"geometry_msgs/PointStamped", false, false, false, false},
                    MessageType{"geometry_msgs/PoseStamped", false, true, false, false},
                    MessageType{"geometry_msgs/PoseWithCovarianceStamped", false, true, true, false},
                    MessageType{"geometry_msgs/TransformStamped", true, true, false, false},
                    MessageType{"nav_msgs/Odometry", true, true, true, true}),
    [](const auto& type) {
      std::string name = type.param.name;
      std::replace(name.begin(), name.end(), '/', '_');
      return name;
    });

}  // namespace
}  // namespace alidade
