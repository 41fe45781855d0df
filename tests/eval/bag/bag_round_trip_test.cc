#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <sstream>

#include "eval/bag/bag_export.h"
#include "eval/bag/bag_import.h"
#include "eval/bag/dataset_images.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/digest.h"
#include "eval/dataset/png_image.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "eval/rosbag/ros_message.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

Dataset Simulated(const std::string& name, const std::vector<std::string>& settings) {
  const Result<SimulatorConfig> config =
      LoadSimulatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/datasets/" + name + ".yaml", settings);
  CHECK(config.ok()) << config.message();
  Result<Dataset> dataset = Simulate(*config, 1);
  CHECK(dataset.ok()) << dataset.message();
  return std::move(*dataset);
}

class BagRoundTrip : public testing::Test {
 protected:
  [[nodiscard]] Result<BagImport> ThroughABag(const Dataset& dataset) const {
    const std::string path = folder_.File("sequence.bag");
    if (const Status status = WriteBag(dataset, {}, path); !status.ok()) {
      return status;
    }
    return ReadBag(path, {});
  }
  test::TemporaryFolder folder_;
};

/// Everything an estimator sees and everything it is scored by.
void ExpectEqual(const Dataset& before, const Dataset& after) {
  EXPECT_EQ(DigestOf(MeasurementsOf(before)), DigestOf(MeasurementsOf(after)));
  ASSERT_TRUE(after.truth);
  ASSERT_EQ(before.truth->points.size(), after.truth->points.size());
  EXPECT_EQ(before.truth->has_velocity, after.truth->has_velocity);
  for (size_t i = 0; i < before.truth->points.size(); ++i) {
    const TrajectoryPoint &a = before.truth->points[i], &b = after.truth->points[i];
    EXPECT_EQ(a.stamp_ns, b.stamp_ns);
    EXPECT_EQ(a.nav.p_WB, b.nav.p_WB);
    EXPECT_EQ(a.nav.R_WB, b.nav.R_WB);
    EXPECT_EQ(a.nav.v_WB, b.nav.v_WB);
    EXPECT_EQ(a.bias.gyro, b.bias.gyro);
  }
}

// GIVEN a simulated sequence with tracks, truth and GNSS of every constellation WHEN it goes through a bag
// THEN an estimator sees the same numbers and is scored by the same truth.
TEST_F(BagRoundTrip, KeepsTracksTruthAndGnss) {
  const Dataset before =
      Simulated("gnss_figure8_short", {"duration_s=3", "path_m=12", "gnss.rate_hz=2", "gnss.outage_s=0",
                                       "gnss.clock_jump_at_s=1", "max_features=20"});
  const Result<BagImport> import = ThroughABag(before);
  ASSERT_TRUE(import.ok()) << import.message();
  ExpectEqual(before, import->dataset);
  ASSERT_TRUE(import->dataset.gnss);
  EXPECT_EQ(before.gnss->glonass_channels, import->dataset.gnss->glonass_channels);
}

// The measurements of a log alone, as an external program gets them.
TEST_F(BagRoundTrip, KeepsADatasetThatWasALog) {
  const Dataset before = Simulated("figure8_short", {"duration_s=2", "path_m=2.6", "max_features=20",
                                                     "camera_count=2", "noise_ratio_spread=0.5"});
  ASSERT_EQ(before.extra_cameras.size(), 1u);
  Dataset of_log = DatasetOf(MeasurementsOf(before));
  of_log.truth = before.truth;
  const Result<BagImport> import = ThroughABag(of_log);
  ASSERT_TRUE(import.ok()) << import.message();
  ExpectEqual(before, import->dataset);
}

// GIVEN images as files WHEN they go through a bag THEN they are read from it pixel by pixel, and one that is
// missing is an error with its path.
TEST_F(BagRoundTrip, KeepsImages) {
  Dataset dataset = Simulated("figure8_short", {"duration_s=1", "path_m=1.3", "max_features=20"});
  GreyImage image;
  image.width_px = dataset.rig.camera.width_px();
  image.height_px = dataset.rig.camera.height_px();
  image.pixels.resize(static_cast<size_t>(image.width_px) * static_cast<size_t>(image.height_px));
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<unsigned char>(i * i % 251);
  }
  ASSERT_TRUE(WritePng(image, folder_.File("image.png")).ok());
  const TimeNs stamp_ns = dataset.frames.front().stamp_ns;
  dataset.frames.clear();
  dataset.images = {{stamp_ns, folder_.File("image.png")}};
  Result<BagImport> import = ThroughABag(dataset);
  ASSERT_TRUE(import.ok()) << import.message();
  ASSERT_EQ(import->dataset.images.size(), 1u);
  DatasetImages reader;
  const Result<GreyImage> read = reader.ReadFor(dataset.rig.camera, import->dataset.images[0]);
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(read->pixels, image.pixels);
  const Result<GreyImage> file = reader.Read(dataset.images[0]);
  ASSERT_TRUE(file.ok()) << file.message();
  EXPECT_EQ(file->pixels, image.pixels);

  const CameraModel small = *CameraModel::Create(DistortionModel::kNone, {300, 300, 3.5, 1.5}, {}, 8, 4);
  EXPECT_THAT(reader.ReadFor(small, dataset.images[0]).message(),
              HasSubstr("expected the resolution 8 x 4 of sensor.yaml"));
  dataset.images[0].path = folder_.File("none.png");
  EXPECT_THAT(ThroughABag(dataset).message(), HasSubstr("none.png"));
}

TEST(BagMessages, TracksThatCannotBeAreRefused) {
  TrackFrame frame{5, {{3, {1, 2}}, {7, {3, 4}}}, 0};
  const std::optional<TrackFrame> back = DecodeTracks(EncodeTracks(frame));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->stamp_ns, 5);
  EXPECT_EQ(back->observations[1].pixel, frame.observations[1].pixel);
  EXPECT_FALSE(DecodeTracks(EncodeTracks(frame).substr(0, 40)));
  frame.observations[1].track_id = 3;  // twice in a frame
  EXPECT_FALSE(DecodeTracks(EncodeTracks(frame)));
  frame.observations[1] = {7, {std::numeric_limits<double>::infinity(), 0}};
  EXPECT_FALSE(DecodeTracks(EncodeTracks(frame)));
  frame.observations = {{-1, {0, 0}}};
  EXPECT_FALSE(DecodeTracks(EncodeTracks(frame)));
}

TEST(BagMessages, AStateWithoutARotationIsRefused) {
  TrajectoryPoint point;
  point.stamp_ns = 9;
  point.nav.v_WB = {1, 2, 3};
  const std::optional<DecodedState> back = DecodeState(EncodeState(point, true));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->has_velocity);
  EXPECT_EQ(back->point.nav.v_WB, point.nav.v_WB);
  EXPECT_FALSE(DecodeState(EncodeState(point, true).substr(0, 60)));
  point.nav.R_WB(0, 0) = -1;  // a reflection
  EXPECT_FALSE(DecodeState(EncodeState(point, true)));
  point.nav.R_WB(0, 0) = 1;
  point.bias.accel.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(DecodeState(EncodeState(point, true)));
}

/// Bytes of a message whose arrays have fixed lengths and whose strings are empty, by its definition.
size_t SizeByDefinition(const std::string& type) {
  static const std::map<std::string, size_t> sizes = {{"bool", 1},    {"uint8", 1}, {"uint32", 4},
                                                      {"float64", 8}, {"time", 8},  {"string", 4}};
  const std::string definition = RosDefinition(type);
  EXPECT_FALSE(definition.empty()) << type;
  std::istringstream fields(definition.substr(0, definition.find("\n=")));
  size_t size = 0;
  for (std::string field, name; fields >> field >> name;) {
    const size_t bracket = field.find('[');
    const std::string base = field.substr(0, bracket);
    const size_t count = bracket == std::string::npos ? 1 : std::stoul(field.substr(bracket + 1));
    size += count * (sizes.count(base) != 0 ? sizes.at(base) : SizeByDefinition(base));
  }
  return size;
}

// GIVEN the definition in a bag, by which other programs read it, THEN the messages are as long as in it.
TEST(BagMessages, AreAsLongAsTheirDefinitions) {
  EXPECT_EQ(EncodeState(TrajectoryPoint(), true).size(), SizeByDefinition("alidade/State"));
  EXPECT_EQ(EncodeImu(ImuSample()).size(), SizeByDefinition("sensor_msgs/Imu"));
}

TEST(BagMessages, AnIonosphereHasEightParameters) {
  const KlobucharParameters parameters{{1, 2, 3, 4}, {5, 6, 7, 8}};
  const std::string message = EncodeIonosphere(3, parameters);
  const Result<KlobucharParameters> back = DecodeIonosphere(message);
  ASSERT_TRUE(back.ok()) << back.message();
  EXPECT_EQ(back->alpha, parameters.alpha);
  EXPECT_EQ(back->beta, parameters.beta);
  EXPECT_THAT(DecodeIonosphere(message.substr(0, message.size() - 8)).message(),
              HasSubstr("expected 8 finite ones"));
  EXPECT_FALSE(
      DecodeIonosphere(EncodeIonosphere(3, {{std::numeric_limits<double>::infinity(), 0, 0, 0}, {}})).ok());
}

}  // namespace
}  // namespace alidade
