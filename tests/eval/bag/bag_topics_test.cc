#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/bag/bag_import.h"
#include "eval/bag/bag_parts.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/rosbag/rosbag_writer.h"
#include "tests/support/temporary_folder.h"

// Which topics of a bag are read.

namespace alidade {
namespace {

using testing::HasSubstr;

TEST(BagTopicsTest, NamesAreChecked) {
  const Result<BagTopics> topics = MakeBagTopics("imu=/a,cam0=/b");
  ASSERT_TRUE(topics.ok()) << topics.message();
  EXPECT_EQ((*topics)["imu"], "/a");
  EXPECT_EQ((*topics)["cam0"], "/b");
  EXPECT_EQ((*topics)["fix"], "/fix0/fix");
  EXPECT_THAT(MakeBagTopics("imy=/a").message(), HasSubstr("imu"));
  EXPECT_FALSE(MakeBagTopics("imu").ok());
  EXPECT_FALSE(MakeBagTopics("imu=").ok());
}

TEST(BagTopicsTest, OfTwoThatCouldBeMeantNoneIsGuessed) {
  const test::TemporaryFolder folder;
  const std::string path = folder.File("two.bag");
  Result<RosbagWriter> bag = RosbagWriter::Create(path, BagCompression::kNone);
  ASSERT_TRUE(bag.ok());
  for (const char* name : {"/left/imu", "/right/imu"}) {
    const std::uint32_t topic = bag->AddTopic(name, "sensor_msgs/Imu");
    for (TimeNs stamp : {1, 2}) {
      ImuSample sample;
      sample.stamp_ns = stamp;
      ASSERT_TRUE(bag->Write(topic, stamp, EncodeImu(sample)).ok());
    }
  }
  ASSERT_TRUE(bag->Close().ok());
  BagImportOptions options;
  options.imu = ImuSensor();
  EXPECT_THAT(ReadBag(path, options).message(), HasSubstr("--topics=imu=TOPIC"));
  options.topics = "imu=/right/imu";
  EXPECT_EQ(ReadBag(path, options)->dataset.imu.size(), 2u);
}

TEST(BagTopicsTest, GivenATopicOfSeveralTypesThenErrorsListAllOfThem) {
  const BagTopic topic{"pose", "/pose", {"a/One", "b/Two", "c/Three"}, BagTopic::Search::kByType};
  BagTopics topics({topic});
  EXPECT_THAT(topics.Resolve("x.bag", {{"/p", "a/One"}, {"/q", "c/Three"}}).message(),
              HasSubstr("2 topics of type a/One, b/Two or c/Three, expected --topics=pose=TOPIC"));
  ASSERT_TRUE(topics.Set("pose=/absent").ok());
  EXPECT_THAT(topics.Resolve("x.bag", {{"/p", "a/One"}}).message(),
              HasSubstr("no topic /absent of type a/One, b/Two or c/Three; found /p (a/One)"));
}

}  // namespace
}  // namespace alidade
