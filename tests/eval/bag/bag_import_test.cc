#include "eval/bag/bag_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "eval/bag/bag_folder.h"
#include "eval/bag/dataset_images.h"
#include "eval/bag/dataset_source.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/png_image.h"
#include "eval/files/byte_io.h"
#include "eval/files/output_file.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "eval/rosbag/ros_header.h"
#include "eval/rosbag/ros_sensor_messages.h"
#include "eval/rosbag/rosbag_writer.h"
#include "frontend/tracking/image_reader.h"
#include "gnss/model/gnss_epoch.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr TimeNs kOffsetNs = -18 * kSecondNs + 1'234'567;  // IMU time - GPST
const TimeNs kGpst = GpsTimeFromWeek(TimeScale::kGps, 2288, 252'801 * kSecondNs);

ImuSensor Noise() {
  ImuSensor sensor;
  sensor.noise = {1e-3, 1e-5, 1e-2, 1e-4};
  return sensor;
}

CameraSensor Camera() {
  CameraSensor sensor;
  sensor.camera = *CameraModel::Create(DistortionModel::kNone, {300, 300, 3.5, 1.5}, {}, 8, 4);
  return sensor;
}

KeplerEphemeris Ephemeris() {
  KeplerEphemeris e;
  e.satellite = {GnssSystem::kGps, 2};
  e.toc_ns = e.toe_ns = e.transmission_ns = kGpst - 801 * kSecondNs;
  e.toe_of_week_s = 252'000;
  e.sqrt_a = 5153.6;
  return e;
}

/// A bag as another system records it, in the names of the GVINS dataset: images of a pattern, IMU, GNSS
/// messages, no sensor sheets.
class ForeignBag : public testing::Test {
 protected:
  void SetUp() override { Record(); }

  void Record() {
    path_ = folder_.File("foreign.bag");
    Result<RosbagWriter> bag = RosbagWriter::Create(path_, BagCompression::kLz4);
    ASSERT_TRUE(bag.ok());
    const std::uint32_t imu = bag->AddTopic("/imu0", "sensor_msgs/Imu");
    const std::uint32_t camera = bag->AddTopic("/cam0/image_raw", "sensor_msgs/Image");
    const std::uint32_t pvt = bag->AddTopic("/ublox_driver/receiver_pvt", "gnss_comm/GnssPVTSolnMsg");
    const std::uint32_t pulse =
        bag->AddTopic("/ublox_driver/time_pulse_info", "gnss_comm/GnssTimePulseInfoMsg");
    const std::uint32_t trigger = bag->AddTopic("/external_trigger", "gvins/LocalSensorExternalTrigger");
    const std::uint32_t range = bag->AddTopic("/ublox_driver/range_meas", "gnss_comm/GnssMeasMsg");
    const std::uint32_t ephemeris = bag->AddTopic("/ublox_driver/ephem", "gnss_comm/GnssEphemMsg");
    if (with_ephemeris_) {
      ASSERT_TRUE(bag->Write(ephemeris, kGpst + kOffsetNs, *EncodeEphemeris(Ephemeris())).ok());
    }
    for (int i = 0; i < 6; ++i) {
      const TimeNs gpst = kGpst + i * kSecondNs;
      const TimeNs local = gpst + kOffsetNs;
      const auto write = [&](std::uint32_t topic, const std::string& message) {
        EXPECT_TRUE(bag->Write(topic, local, message).ok());
      };
      // The trigger of this second comes before the next pulse is announced; one is late by a hiccup of the
      // clock.
      if (i > 0) {
        write(trigger, EncodeTrigger(local + (i == 3 ? 400'000'000 : 0)));
      }
      write(pulse, EncodeTimePulse(gpst + kSecondNs));
      ImuSample sample;
      sample.stamp_ns = i == 4 ? local - 2 * kSecondNs + 1 : local;  // one out of order
      sample.accel = {0, 0, 9.81};
      write(imu, EncodeImu(sample));
      if (i == 5) {
        write(imu, EncodeImu(sample));
        sample.stamp_ns += 1;
        sample.accel.x() = std::nan("");
        write(imu, EncodeImu(sample));
      }
      const std::string pattern(32, static_cast<char>('a' + i));
      write(camera, EncodeImage(local, 8, 4, pattern));
      // Carrier: float, then fixed. The antenna goes north.
      write(pvt, EncodeSolution({gpst, true, i < 2 ? 1 : 2, 22.3 + 1e-5 * i, 114.2, 5.0, 0.01, 0.02}));
      ObservationEpoch epoch;
      epoch.stamp_ns = gpst + tags_late_ns_;
      epoch.satellites = {{{GnssSystem::kGps, 2}, {{{'1', 'C'}, 2.2e7, {}, 1.0, 45.0, 0, {}, {}}}}};
      write(range, EncodeMeasurements(epoch, {}));
    }
    ASSERT_TRUE(bag->Close().ok());
  }

  Result<BagImport> Read() const {
    BagImportOptions options;
    options.imu = Noise();
    options.camera = Camera();
    options.take_image = [](const BagImage&) { return Status::Ok(); };
    return ReadBag(path_, options);
  }

  test::TemporaryFolder folder_;
  std::string path_;
  bool with_ephemeris_ = true;
  TimeNs tags_late_ns_ = 0;
};

TEST_F(ForeignBag, TheTimeOffsetIsThatOfTheTriggers) {
  const Result<BagImport> import = Read();
  ASSERT_TRUE(import.ok()) << import.message();
  EXPECT_NEAR(import->dataset.rig.gnss.time_offset_s, 1e-9 * static_cast<double>(kOffsetNs), 1e-9);
  EXPECT_THAT(import->remarks, Contains(HasSubstr("median over 5 triggers")));
  EXPECT_THAT(import->remarks, Contains(HasSubstr("lever arm")));
}

TEST_F(ForeignBag, TheTruthIsTheFixedSolutionInEnu) {
  const Result<BagImport> import = Read();
  ASSERT_TRUE(import.ok()) << import.message();
  const Trajectory& truth = *import->dataset.truth;
  EXPECT_FALSE(truth.has_orientation);
  ASSERT_EQ(truth.points.size(), 4u);  // without the two float ones
  EXPECT_EQ(truth.points[0].stamp_ns, kGpst + 2 * kSecondNs + kOffsetNs);
  EXPECT_NEAR(truth.points[0].nav.p_WB.norm(), 0, 1e-6);
  // An arc of 1e-5 degrees along the meridian: radius of curvature 6345 km at 22.3 degrees.
  EXPECT_NEAR(truth.points[1].nav.p_WB.y(), 1e-5 * 3.14159265358979 / 180 * 6345e3, 2e-3);
  EXPECT_NEAR(truth.points[1].nav.p_WB.x(), 0, 1e-6);
}

TEST_F(ForeignBag, StampsOutOfOrderAreSorted) {
  const Result<BagImport> import = Read();
  ASSERT_TRUE(import.ok()) << import.message();
  const std::vector<ImuSample>& imu = import->dataset.imu;
  ASSERT_EQ(imu.size(), 6u);
  for (size_t i = 1; i < imu.size(); ++i) {
    EXPECT_LT(imu[i - 1].stamp_ns, imu[i].stamp_ns);
  }
}

TEST_F(ForeignBag, ImuSamplesThatCannotBeUsedAreCounted) {
  const Result<BagImport> import = Read();
  ASSERT_TRUE(import.ok()) << import.message();
  EXPECT_EQ(import->dataset.imu_rejections.duplicate, 1u);
  EXPECT_EQ(import->dataset.imu_rejections.not_finite, 1u);
}

TEST_F(ForeignBag, BecomesAFolderThatReads) {
  BagImportOptions options;
  options.imu = Noise();
  options.camera = Camera();
  const auto remarks = ConvertBagToFolder(path_, options, folder_.File("out"));
  ASSERT_TRUE(remarks.ok()) << remarks.message();
  const Result<Dataset> dataset = ReadDataset(folder_.File("out"));
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  ASSERT_EQ(dataset->images.size(), 6u);
  EXPECT_EQ(dataset->images[3].stamp_ns, kGpst + 3 * kSecondNs + kOffsetNs);
  EXPECT_EQ(ReadGreyImage(dataset->images[3].path)->pixels, std::vector<unsigned char>(32, 'd'));
  EXPECT_NEAR(dataset->camera_rate_hz, 1, 1e-12);
  EXPECT_EQ(dataset->gnss->epochs.size(), 6u);
  EXPECT_FALSE(dataset->truth->has_orientation);
  EXPECT_EQ(dataset->truth->points.size(), 4u);
  EXPECT_NEAR(dataset->rig.gnss.time_offset_s, 1e-9 * static_cast<double>(kOffsetNs), 1e-9);
}

TEST_F(ForeignBag, ItsImagesAreReadWhereTheyLie) {
  BagImportOptions options;
  options.imu = Noise();
  options.camera = Camera();
  const Result<BagImport> import = ReadBag(path_, options);
  ASSERT_TRUE(import.ok()) << import.message();
  const std::vector<ImageEntry>& entries = import->dataset.images;
  ASSERT_EQ(entries.size(), 6u);
  EXPECT_NEAR(import->dataset.camera_rate_hz, 1, 1e-12);
  DatasetImages images;
  for (const size_t i : {3, 0, 5}) {
    EXPECT_EQ(entries[i].stamp_ns, kGpst + static_cast<TimeNs>(i) * kSecondNs + kOffsetNs);
    const Result<GreyImage> image = images.Read(entries[i]);
    ASSERT_TRUE(image.ok()) << image.message();
    EXPECT_EQ(image->pixels, std::vector<unsigned char>(32, static_cast<unsigned char>('a' + i)));
  }
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 4);
  EXPECT_THAT(DatasetImages().Read(entries[5]).message(), HasSubstr("any more"));
}

TEST_F(ForeignBag, ACompressedImageIsReadWhereItLies) {
  const GreyImage pattern{.width_px = 8, .height_px = 4, .pixels = std::vector<unsigned char>(32, 'q')};
  ASSERT_TRUE(WritePng(pattern, folder_.File("q.png")).ok());
  ByteWriter message;
  PutRosHeader(kGpst, &message);
  message.Block("png");
  message.Block(test::ReadFile(folder_.File("q.png")));
  Result<RosbagWriter> bag = RosbagWriter::Create(folder_.File("png.bag"), BagCompression::kBz2);
  ASSERT_TRUE(bag.ok());
  const std::uint32_t imu = bag->AddTopic("/imu0", "sensor_msgs/Imu");
  for (const TimeNs stamp_ns : {kGpst, kGpst + kSecondNs}) {
    ImuSample sample;
    sample.stamp_ns = stamp_ns;
    ASSERT_TRUE(bag->Write(imu, stamp_ns, EncodeImu(sample)).ok());
  }
  ASSERT_TRUE(
      bag->Write(bag->AddTopic("/cam0/image_raw", "sensor_msgs/CompressedImage"), kGpst, message.bytes())
          .ok());
  ASSERT_TRUE(bag->Close().ok());
  BagImportOptions options;
  options.imu = Noise();
  options.camera = Camera();
  const Result<BagImport> import = ReadBag(folder_.File("png.bag"), options);
  ASSERT_TRUE(import.ok()) << import.message();
  ASSERT_EQ(import->dataset.images.size(), 1u);
  const Result<GreyImage> image = DatasetImages().Read(import->dataset.images[0]);
  ASSERT_TRUE(image.ok()) << image.message();
  EXPECT_EQ(image->pixels, pattern.pixels);
}

TEST_F(ForeignBag, ReadsWithTheCalibrationOfOtherPrograms) {
  DatasetSource source{
      path_, "pvt=/ublox_driver/receiver_pvt", {folder_.File("imu.yaml"), folder_.File("camera.yaml")}};
  ASSERT_TRUE(
      WriteFileAtomically(source.calibration[0], "acc_n: 0.08\ngyr_n: 0.004\nacc_w: 0.00004\ngyr_w: 2.0e-6\n")
          .ok());
  ASSERT_TRUE(WriteFileAtomically(source.calibration[1],
                                  "model_type: PINHOLE\nimage_width: 8\nimage_height: 4\n"
                                  "distortion_parameters: {k1: 0, k2: 0, p1: 0, p2: 0}\n"
                                  "projection_parameters: {fx: 300, fy: 300, cx: 3.5, cy: 1.5}\n"
                                  "body_T_cam0: {rows: 4, cols: 4, dt: d,\n"
                                  "  data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n")
                  .ok());
  const Result<Dataset> dataset = ReadDataset(source);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_FALSE(dataset->has_sheets);
  EXPECT_EQ(dataset->images.size(), 6u);
  EXPECT_NEAR(dataset->rig.T_BC.translation.x(), 0.1, 1e-12);
  EXPECT_THAT(dataset->remarks, Contains(HasSubstr("lever arm")));
  const std::string digest = DigestOf(source).value();
  ASSERT_TRUE(
      WriteFileAtomically(source.calibration[0], "acc_n: 0.09\ngyr_n: 0.004\nacc_w: 0.00004\ngyr_w: 2.0e-6\n")
          .ok());
  EXPECT_NE(DigestOf(source).value(), digest)
      << "the front end's tracks would be taken for those of another rig";
  source.follow_links = true;
  EXPECT_THAT(ReadDataset(source).message(), HasSubstr("found a bag, expected a folder for follow_links"));
  source.follow_links = false;
  source.topics = "cam0=/none";
  EXPECT_THAT(ReadDataset(source).message(), HasSubstr("no topic /none"));
  source.path = folder_.path();
  EXPECT_THAT(ReadDataset(source).message(),
              HasSubstr("found a folder, expected a bag for topics or calibration"));
}

TEST_F(ForeignBag, ObservationsWithoutEphemerisAreLeftOut) {
  with_ephemeris_ = false;
  Record();
  const Result<BagImport> import = Read();
  ASSERT_TRUE(import.ok()) << import.message();
  EXPECT_EQ(import->dataset.gnss, nullptr);
  EXPECT_THAT(import->remarks, Contains(HasSubstr("no ephemeris")));
  EXPECT_TRUE(import->dataset.truth.has_value());
}

TEST_F(ForeignBag, TagsOfAWeekNumberThatRolledOverAreRefused) {
  tags_late_ns_ = -1024 * 7 * 86'400 * kSecondNs;
  Record();
  const std::string message = Read().message();
  EXPECT_THAT(message, HasSubstr(path_ + ": /ublox_driver/range_meas: "));
  EXPECT_THAT(message, HasSubstr("+1024 weeks"));
}

TEST_F(ForeignBag, NamesWhatIsMissing) {
  BagImportOptions options;
  EXPECT_THAT(ReadBag(path_, options).message(), HasSubstr("noise of the IMU"));
  options.imu = Noise();
  EXPECT_THAT(ReadBag(path_, options).message(), HasSubstr("calibration of the camera"));
  options.topics = "imu=/imu/data";
  EXPECT_THAT(ReadBag(path_, options).message(),
              testing::AllOf(HasSubstr("no topic /imu/data"), HasSubstr("/imu0 (sensor_msgs/Imu)")));
}

}  // namespace
}  // namespace alidade
