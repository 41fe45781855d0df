#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "eval/files/byte_io.h"
#include "eval/rosbag/ros_message.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/rosbag/rosbag_reader.h"
#include "eval/rosbag/rosbag_writer.h"
#include "tests/integration/command.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr int kSamples = 3000;  // several chunks

ImuSample SampleAt(int i) {
  ImuSample sample;
  sample.stamp_ns = 1'600'000'000'000'000'000 + 5'000'001LL * i;
  sample.gyro = {0.1 * i, -0.2, 1e-9};
  sample.accel = {9.81, i / 3.0, -0.0};
  return sample;
}

std::string WriteSamples(const test::TemporaryFolder& folder, BagCompression compression) {
  std::string path = folder.File(std::string(ToString(compression)) + ".bag");
  Result<RosbagWriter> bag = RosbagWriter::Create(path, compression);
  EXPECT_TRUE(bag.ok()) << bag.message();
  const std::uint32_t imu = bag->AddTopic("/imu0", "sensor_msgs/Imu");
  const std::uint32_t text = bag->AddTopic("/note", "std_msgs/String", true);
  EXPECT_TRUE(bag->Write(text, SampleAt(0).stamp_ns, EncodeText("hello")).ok());
  for (int i = 0; i < kSamples; ++i) {
    EXPECT_TRUE(bag->Write(imu, SampleAt(i).stamp_ns, EncodeImu(SampleAt(i))).ok());
  }
  EXPECT_TRUE(bag->Close().ok());
  return path;
}

/// Reads the samples of a bag; every one must be as it was written.
BagScan ReadSamples(const std::string& path, int* samples) {
  *samples = 0;
  Result<RosbagReader> bag = RosbagReader::Open(path);
  EXPECT_TRUE(bag.ok()) << bag.message();
  const Result<BagScan> scan = bag->Scan([&](const BagMessage& message) {
    if (message.connection->topic == "/imu0") {
      const std::optional<ImuSample> sample = DecodeImu(message.data);
      EXPECT_EQ(message.data, EncodeImu(SampleAt(*samples)));
      EXPECT_TRUE(sample && sample->accel == SampleAt(*samples).accel &&
                  sample->gyro == SampleAt(*samples).gyro);
      EXPECT_EQ(message.received_ns, SampleAt(*samples).stamp_ns);
      ++*samples;
    }
    return Status::Ok();
  });
  EXPECT_TRUE(scan.ok()) << scan.message();
  return *scan;
}

class Rosbag : public testing::TestWithParam<BagCompression> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(Rosbag, GivesBackWhatWasWritten) {
  const std::string path = WriteSamples(folder_, GetParam());
  int samples = 0;
  const BagScan scan = ReadSamples(path, &samples);
  EXPECT_EQ(samples, kSamples);
  EXPECT_EQ(scan.messages, kSamples + 1);
  EXPECT_GT(scan.chunks, 1);
  EXPECT_EQ(scan.damaged, 0);
  EXPECT_FALSE(scan.truncated);
  EXPECT_TRUE(scan.indexed);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST_P(Rosbag, ReadsAMessageAgainByItsPlace) {
  Result<RosbagReader> bag = RosbagReader::Open(WriteSamples(folder_, GetParam()));
  ASSERT_TRUE(bag.ok());
  std::vector<BagPlace> places;
  const auto keep = [&](const BagMessage& message) {
    places.push_back(message.place);
    return Status::Ok();
  };
  ASSERT_TRUE(bag->Scan(keep).ok());
  ASSERT_EQ(places.size(), kSamples + 1u);
  for (const int i : {kSamples - 1, 0, 1, kSamples / 2}) {
    const Result<std::string_view> again = bag->ReadAgain(places[static_cast<size_t>(i) + 1]);
    ASSERT_TRUE(again.ok()) << again.message();
    EXPECT_EQ(*again, EncodeImu(SampleAt(i))) << i;
  }
  BagPlace beyond = places.back();
  beyond.length = std::string::npos;
  EXPECT_FALSE(bag->ReadAgain(beyond).ok());
  beyond.record = std::uint64_t{1} << 62;
  EXPECT_FALSE(bag->ReadAgain(beyond).ok());
}

TEST_P(Rosbag, CutOffGivesTheChunksThatAreWhole) {
  const std::string whole = test::ReadFile(WriteSamples(folder_, GetParam()));
  int before = 0;
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9, 0.97}) {
    const std::string path = folder_.Write(
        "cut.bag", whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    int samples = 0;
    const BagScan scan = ReadSamples(path, &samples);
    EXPECT_TRUE(scan.truncated) << share;
    EXPECT_GE(samples, before) << share;
    before = samples;
  }
  EXPECT_GT(before, kSamples / 2);
}

TEST_P(Rosbag, NeverClosedIsReadAndSaidToBe) {
  const std::string path = WriteSamples(folder_, GetParam());
  // What a recorder that was killed leaves: a bag header without index position, and no records behind the
  // chunks.
  std::string bytes = test::ReadFile(path);
  const std::size_t position = bytes.find("index_pos=") + 10;
  const auto end = ByteReader(std::string_view(bytes).substr(position)).Read<std::uint64_t>();
  bytes.resize(end);
  bytes.replace(position, 8, std::string(8, '\0'));
  int samples = 0;
  const BagScan scan = ReadSamples(folder_.Write("active.bag", bytes), &samples);
  EXPECT_EQ(samples, kSamples);
  EXPECT_FALSE(scan.indexed);
  EXPECT_FALSE(scan.truncated);
}

// Whatever bytes are wrong, reading ends, allocates within bounds and gives no more than was there.
TEST_P(Rosbag, DamagedBytesDoNotLeadItAstray) {
  const std::string whole = test::ReadFile(WriteSamples(folder_, GetParam()));
  std::mt19937_64 random(7);
  int damaged = 0;
  for (int round = 0; round < 50; ++round) {
    std::string bytes = whole;
    for (int i = 0; i < 8; ++i) {
      bytes[13 + random() % (bytes.size() - 13)] = static_cast<char>(random());
    }
    Result<RosbagReader> bag = RosbagReader::Open(folder_.Write("damaged.bag", bytes));
    ASSERT_TRUE(bag.ok());
    const Result<BagScan> scan = bag->Scan([](const BagMessage& message) {
      static_cast<void>(DecodeImu(message.data));
      return Status::Ok();
    });
    ASSERT_TRUE(scan.ok());
    EXPECT_LE(scan->messages, kSamples + 1);
    damaged += scan->damaged > 0 || scan->truncated || scan->messages < kSamples + 1 ? 1 : 0;
  }
  EXPECT_GT(damaged, 10);
}

constexpr const char* kOracle = R"(
import hashlib, sys
import genpy.dynamic, rosbag
bag = rosbag.Bag(sys.argv[1])
count, digest = 0, hashlib.md5()
for topic, raw, stamp in bag.read_messages(raw=True):
    kind, data, md5sum = raw[0], raw[1], raw[2]
    count += 1
    digest.update(data)
for info in bag._connections.values():
    made = genpy.dynamic.generate_dynamic(info.datatype, info.msg_def)[info.datatype]
    assert made._md5sum == info.md5sum, (info.datatype, made._md5sum, info.md5sum)
for topic, message, stamp in bag.read_messages(topics=['/imu0']):
    assert message.header.stamp == stamp
print(count, bag.get_message_count(), digest.hexdigest(), message.linear_acceleration.y)
)";

bool HasOracle() {
  return std::system("/usr/bin/python3 -c 'import rosbag, genpy' > /dev/null 2>&1") == 0;
}

TEST_P(Rosbag, PythonRosbagReadsTheSame) {
  if (!HasOracle()) {
    GTEST_SKIP() << "Debian's python3-rosbag is not installed";
  }
  const std::string path = WriteSamples(folder_, GetParam());
  const test::CommandResult answer =
      test::Shell("/usr/bin/python3 " + folder_.Write("oracle.py", kOracle) + " " + path);
  ASSERT_EQ(answer.code, 0) << answer.output;
  EXPECT_THAT(answer.output, testing::StartsWith("3001 3001 "));
  EXPECT_THAT(answer.output, HasSubstr(" 999.6666666666666"));
}

INSTANTIATE_TEST_SUITE_P(Compressions, Rosbag,
                         testing::Values(BagCompression::kNone, BagCompression::kBz2, BagCompression::kLz4),
                         [](const auto& test) { return std::string(ToString(test.param)); });

// Every definition: ROS's own parser must read it and find the same sum.
TEST(RosDefinitions, HaveTheSumsThatRosComputes) {
  if (!HasOracle()) {
    GTEST_SKIP() << "Debian's python3-rosbag is not installed";
  }
  const test::TemporaryFolder folder;
  const std::string path = folder.File("all.bag");
  Result<RosbagWriter> bag = RosbagWriter::Create(path, BagCompression::kNone);
  ASSERT_TRUE(bag.ok());
  for (const std::string& type : RosTypes()) {
    const std::uint32_t topic = bag->AddTopic("/" + type, type);
    ASSERT_TRUE(bag->Write(topic, 1, "").ok());
  }
  const std::uint32_t imu = bag->AddTopic("/imu0", "sensor_msgs/Imu");
  ImuSample sample;
  sample.stamp_ns = 1;
  ASSERT_TRUE(bag->Write(imu, 1, EncodeImu(sample)).ok());
  ASSERT_TRUE(bag->Close().ok());
  const test::CommandResult answer =
      test::Shell("/usr/bin/python3 " + folder.Write("oracle.py", kOracle) + " " + path);
  EXPECT_EQ(answer.code, 0) << answer.output;
}

TEST(RosDefinitions, HaveThePublishedSums) {
  EXPECT_EQ(RosMd5("std_msgs/Header"), "2176decaecbce78abc3b96ef049fabed");
  EXPECT_EQ(RosMd5("std_msgs/String"), "992ce8a1687cec8c8bd883ec73ca41d1");
  EXPECT_EQ(RosMd5("sensor_msgs/Imu"), "6a62c6daae103f4ff57a132d6f95cec2");
  EXPECT_EQ(RosMd5("sensor_msgs/Image"), "060021388200f6f0f447d0fcd9c64743");
  EXPECT_EQ(RosMd5("sensor_msgs/CompressedImage"), "8f7a12909da2c9d3332d540a0977563f");
  EXPECT_EQ(RosMd5("sensor_msgs/NavSatStatus"), "331cdbddfa4bc96ffc3b9ad98900a54c");
  EXPECT_EQ(RosMd5("sensor_msgs/NavSatFix"), "2d3a8cd499b9b4a0249fb98fd05cfa48");
  EXPECT_EQ(RosMd5("geometry_msgs/PointStamped"), "c63aecb41bfdfd6b7e1fac37c7cbe7bf");
  EXPECT_EQ(RosMd5("geometry_msgs/PoseStamped"), "d3812c3cbc69362b77dc0b19b345f8f5");
  EXPECT_EQ(RosMd5("geometry_msgs/PoseWithCovarianceStamped"), "953b798c0f514ff060a53a3498ce6246");
  EXPECT_EQ(RosMd5("geometry_msgs/TransformStamped"), "b5764a33bfeb3588febc2682852579b0");
  EXPECT_EQ(RosMd5("nav_msgs/Odometry"), "cd5e73d190d741a2f92e81eda573aca7");
  EXPECT_EQ(RosMd5("sensor_msgs/Nothing"), "");
}

TEST(RosbagOpen, NamesWhatIsNoBag) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(RosbagReader::Open(folder.File("none.bag")).message(),
              HasSubstr("cannot be read: No such file"));
  EXPECT_THAT(RosbagReader::Open(folder.Write("old.bag", "#ROSBAG V1.2\nxxxxxxxx")).message(),
              HasSubstr("format 1.x"));
  EXPECT_THAT(RosbagReader::Open(folder.Write("text.bag", "hello")).message(), HasSubstr("found no bag"));
}

TEST(RosbagWriter, RefusesStampsThatRosCannotHold) {
  const test::TemporaryFolder folder;
  Result<RosbagWriter> bag = RosbagWriter::Create(folder.File("a.bag"), BagCompression::kNone);
  ASSERT_TRUE(bag.ok());
  const std::uint32_t topic = bag->AddTopic("/note", "std_msgs/String");
  EXPECT_EQ(bag->Write(topic, -1, EncodeText("x")).code(), StatusCode::kInput);
  EXPECT_EQ(bag->Write(topic, (TimeNs{1} << 32) * 1'000'000'000, EncodeText("x")).code(), StatusCode::kInput);
}

TEST(RosChunk, AClaimedSizeIsNotBelieved) {
  const Result<std::string> packed = PackChunk(BagCompression::kBz2, std::string(1000, 'x'));
  ASSERT_TRUE(packed.ok());
  EXPECT_TRUE(UnpackChunk(BagCompression::kBz2, *packed, 1000).ok());
  EXPECT_FALSE(UnpackChunk(BagCompression::kBz2, *packed, 999).ok());
  EXPECT_FALSE(UnpackChunk(BagCompression::kBz2, *packed, kMaxChunkBytes).ok());
  EXPECT_THAT(UnpackChunk(BagCompression::kNone, "abc", kMaxChunkBytes + 1).message(), HasSubstr("at most"));
}

TEST(RosImages, BecomeGrey) {
  const std::string colour = {char(255), 0, 0, 0, char(255), 0};  // a blue and a green pixel of bgr8
  const RawImage bgr{0, 2, 1, "bgr8", false, 6, colour};
  EXPECT_EQ(GreyOf(bgr)->pixels, (std::vector<unsigned char>{29, 150}));
  const std::string deep = {0, char(255), 0, 0};
  EXPECT_EQ(GreyOf({0, 2, 1, "mono16", false, 4, deep})->pixels[0], 254);
  EXPECT_EQ(GreyOf({0, 2, 1, "mono16", true, 4, deep})->pixels[0], 1);
  EXPECT_FALSE(GreyOf({0, 2, 1, "bayer_rggb8", false, 2, deep}).has_value());
  EXPECT_FALSE(GreyOf({0, 2, 1, "bgr8", false, 4, deep}).has_value());
  const std::string message = EncodeImage(5, 2, 2, "abcd");
  const std::optional<RawImage> back = DecodeImage(message);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(GreyOf(*back)->pixels, (std::vector<unsigned char>{'a', 'b', 'c', 'd'}));
  EXPECT_FALSE(DecodeImage(message.substr(0, message.size() - 1)).has_value());
}

}  // namespace
}  // namespace alidade
