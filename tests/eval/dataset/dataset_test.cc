#include "eval/dataset/dataset.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "eval/dataset/dataset_check.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/digest.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

Dataset SmallDataset() {
  Dataset dataset;
  dataset.imu_rate_hz = 200;
  dataset.camera_rate_hz = 20;
  dataset.rig.camera = CameraModel::Create(DistortionModel::kRadialTangential,
                                           Eigen::Vector4d(458.654, 457.296, 367.215, 248.375),
                                           {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}, 752, 480)
                           .value();
  dataset.rig.T_BC.rotation = so3::Exp(Eigen::Vector3d(0.3, -1.2, 0.7));
  dataset.rig.T_BC.translation = Eigen::Vector3d(-0.0216401454975, -0.064676986768, 1.0 / 3.0);
  dataset.rig.imu_noise.gyro_noise_density_radps_sqrthz = 1.6968e-4;
  dataset.rig.camera_time_offset_s = -0.0123456789;
  dataset.rig.line_delay_s = 2.9737e-5;
  const TimeNs start = 1403715273262142976;
  Trajectory truth;
  truth.has_velocity = truth.has_bias = true;
  for (int i = 0; i < 50; ++i) {
    const TimeNs stamp = start + i * TimeNs{5'000'000};
    const Eigen::Vector3d wave(std::sin(0.1 * i), std::cos(0.3 * i), 1e-9 * i);
    dataset.imu.push_back({stamp, wave / 7, Eigen::Vector3d(0, 0, 9.81) + wave / 3});
    TrajectoryPoint point;
    point.stamp_ns = stamp;
    point.nav = {so3::Exp(wave), wave * 10, -wave};
    point.bias = {wave * 1e-3, wave * 1e-2};
    truth.points.push_back(point);
  }
  for (int i = 0; i < 5; ++i) {
    TrackFrame frame;
    frame.stamp_ns = start + i * TimeNs{50'000'000};
    for (int j = 0; j < (i == 2 ? 0 : 4); ++j) {
      frame.observations.push_back({10 * i + j, Eigen::Vector2d(100.1 / (1 + j), 200.3 + i)});
    }
    dataset.frames.push_back(frame);
  }
  dataset.truth = truth;
  return dataset;
}

MeasurementLog LogOf(const Dataset& dataset) {
  return {dataset.rig, dataset.imu, dataset.frames};
}

TEST(Dataset, WhenWrittenAndReadThenMeasurementsAreEqualToTheLastBit) {
  const test::TemporaryFolder folder;
  const Dataset written = SmallDataset();
  ASSERT_TRUE(WriteDataset(written, folder.path()).ok());
  const Result<Dataset> read = ReadDataset(folder.path());
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(DigestOf(LogOf(written)), DigestOf(LogOf(*read)));
  EXPECT_EQ(read->imu_rate_hz, 200);
  EXPECT_EQ(read->camera_rate_hz, 20);
  EXPECT_EQ(read->rig.T_BC.rotation, written.rig.T_BC.rotation);
  EXPECT_EQ(read->rig.line_delay_s, 2.9737e-5);
  ASSERT_EQ(read->frames.size(), 5u);
  EXPECT_TRUE(read->frames[2].observations.empty()) << "a frame that saw nothing survives";
  ASSERT_TRUE(read->truth.has_value());
  ASSERT_EQ(read->truth->points.size(), written.truth->points.size());
  EXPECT_TRUE(read->truth->has_velocity && read->truth->has_bias && !read->truth->has_covariance);
  for (size_t i = 0; i < read->truth->points.size(); ++i) {
    const TrajectoryPoint& a = written.truth->points[i];
    const TrajectoryPoint& b = read->truth->points[i];
    EXPECT_EQ(a.stamp_ns, b.stamp_ns);
    EXPECT_EQ(a.nav.p_WB, b.nav.p_WB);
    EXPECT_EQ(a.nav.v_WB, b.nav.v_WB);
    EXPECT_EQ(a.bias.gyro, b.bias.gyro);
    EXPECT_EQ(a.bias.accel, b.bias.accel);
    EXPECT_LT((a.nav.R_WB - b.nav.R_WB).norm(), 1e-14);
  }
}

/// SmallDataset with all that a sequence may have beside it, written to `folder`; GNSS as files alone.
void WriteFullSequence(const test::TemporaryFolder& folder) {
  Dataset full = SmallDataset();
  full.extra_cameras.push_back({full.rig.camera, full.rig.T_BC, 0, full.frames});
  full.rig.fixes.resize(2);
  for (int i = 0; i < 4; ++i) {
    full.fixes.push_back({full.imu.front().stamp_ns + i * TimeNs{10'000'000}, i % 2, Eigen::Vector3d(1, 2, i),
                          Eigen::Matrix3d::Identity()});
  }
  ASSERT_TRUE(WriteDataset(full, folder.path()).ok());
  folder.Write("mav0/gnss0/sensor.yaml", "observations: obs.rnx\n");
  folder.Write("mav0/cam0/hall.csv", "#shape\n");
  folder.Write("mav0/cam0/data.csv", "#timestamp [ns],filename\n1,1.png\n");
  folder.Write("mav0/cam5/data/1.png", "of a camera that is no part of the sequence");
  folder.Write("mav0/notes.txt", "of the user");
}

bool Exists(const test::TemporaryFolder& folder, const std::string& name) {
  return std::filesystem::exists(folder.File("mav0/" + name));
}

// GIVEN a sequence with everything WHEN one with less is written over it THEN what is read is the new one.
TEST(Dataset, WhenWrittenOverAnotherThenNothingOfThatOneIsRead) {
  const test::TemporaryFolder folder;
  WriteFullSequence(folder);
  Dataset written = SmallDataset();
  written.truth->has_velocity = written.truth->has_bias = false;
  written.frames[2].observations = {{99, {1, 2}}};  // all frames see something: no timestamps.csv
  ASSERT_TRUE(WriteDataset(written, folder.path()).ok());
  const Result<Dataset> read = ReadDataset(folder.path());
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(DigestOf(LogOf(written)), DigestOf(LogOf(*read)));
  EXPECT_EQ(read->gnss, nullptr);
  EXPECT_TRUE(read->fixes.empty() && read->rig.fixes.empty());
  EXPECT_TRUE(read->extra_cameras.empty() && read->images.empty() && read->camera_stamps.empty());
  EXPECT_FALSE(read->truth->has_velocity);
  for (const char* stale : {"gnss0", "fix0", "fix1", "cam1", "cam0/hall.csv", "cam0/data.csv",
                            "cam0/timestamps.csv", "state_groundtruth_estimate0/data.csv"}) {
    EXPECT_FALSE(Exists(folder, stale)) << stale;
  }
  EXPECT_TRUE(Exists(folder, "cam5/data/1.png") && Exists(folder, "notes.txt"));
}

// GIVEN images that were just put there, as a bag's are, THEN their list stays and the old tracks go; without
// truth the old one goes.
TEST(Dataset, WhenImagesAreWrittenOverTracksThenTheTracksAreGone) {
  const test::TemporaryFolder folder;
  WriteFullSequence(folder);
  Dataset written = SmallDataset();
  written.frames.clear();
  written.truth.reset();
  written.images = {{1, folder.Write("mav0/cam0/data/1.png", "")}};
  ASSERT_TRUE(WriteDataset(written, folder.path()).ok());
  EXPECT_TRUE(Exists(folder, "cam0/data.csv") && Exists(folder, "cam0/sensor.yaml"));
  EXPECT_FALSE(Exists(folder, "cam0/tracks.csv") || Exists(folder, "cam0/timestamps.csv"));
  EXPECT_FALSE(Exists(folder, "state_groundtruth_estimate0"));
}

// GIVEN a sequence that is written back to its own folder THEN what the dataset does not hold stays.
TEST(Dataset, WhenWrittenInPlaceThenNothingIsRemoved) {
  const test::TemporaryFolder folder;
  WriteFullSequence(folder);
  Dataset written = SmallDataset();
  written.path = folder.path();
  written.truth.reset();
  ASSERT_TRUE(WriteDataset(written, folder.path()).ok());
  for (const char* kept : {"gnss0/sensor.yaml", "fix1/data.csv", "cam1/tracks.csv", "cam0/hall.csv",
                           "cam0/data.csv", "state_groundtruth_estimate0/data.csv"}) {
    EXPECT_TRUE(Exists(folder, kept)) << kept;
  }
}

TEST(Dataset, WhenOneBitOfTheLogChangesThenItsDigestChanges) {
  const MeasurementLog log = LogOf(SmallDataset());
  const std::string digest = DigestOf(log);
  EXPECT_EQ(digest.size(), 64u);
  std::vector<MeasurementLog> changed(9, log);
  changed[0].imu[3].gyro[1] = std::nextafter(changed[0].imu[3].gyro[1], 1e9);
  changed[1].imu.back().stamp_ns += 1;
  changed[2].frames[1].observations[2].track_id += 1;
  changed[3].frames[1].observations[2].pixel[0] += 1e-13;
  changed[4].rig.camera_time_offset_s = 0;
  changed[5].rig.imu_noise.accel_random_walk_mps3_sqrthz *= 2;
  changed[6].frames.pop_back();
  changed[7].rig.line_delay_s = 0;
  changed[8].frames[1].observations[2].noise_ratio = 2;
  for (size_t i = 0; i < changed.size(); ++i) {
    EXPECT_NE(DigestOf(changed[i]), digest) << "change " << i;
  }
  MeasurementLog slower = log;
  slower.frames[0].frontend_ms = 5;
  EXPECT_EQ(DigestOf(slower), digest) << "time spent is no input";
}

TEST(Dataset, GivenAnEmptyLogThenTheDigestIsTheKnownSha256OfItsBytes) {
  // Computed apart with Python's hashlib from the same canonical words.
  MeasurementLog log;
  log.rig.imu_noise = {0, 0, 0, 0};
  EXPECT_EQ(DigestOf(log), "60869adf2f760cdd276e5d9b5e2fe78474d6f5e37e4a91ebdb48a4246cd84248");
}

TEST(Dataset, GivenTheRealSequencesThenEachReads) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  int count = 0;
  for (const char* set : {"euroc", "euroc_micro", "tumvi", "tracks", "ovsim"}) {
    for (const auto& entry : std::filesystem::directory_iterator(test::SharedDir() + "/data/" + set)) {
      const auto start = std::chrono::steady_clock::now();
      const Result<Dataset> dataset = ReadDataset(entry.path().string());
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      ASSERT_TRUE(dataset.ok()) << dataset.message();
      EXPECT_LT(elapsed.count(), 2.0) << entry.path() << " reads slowly";
      EXPECT_GT(dataset->imu.size(), 1000u);
      EXPECT_GT(dataset->frames.size() + dataset->images.size() + dataset->camera_stamps.size(), 90u);
      EXPECT_EQ(dataset->name, entry.path().filename().string());
      for (const DatasetFinding& finding : CheckDataset(*dataset)) {
        EXPECT_NE(finding.severity, DatasetFinding::Severity::kError)
            << dataset->name << ": " << finding.text;
      }
      ++count;
    }
  }
  EXPECT_EQ(count, 15);
}

TEST(Dataset, GivenTheTangoSequenceThenItsFovCameraIsRead) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Result<Dataset> dataset = ReadDataset(test::SharedDir() + "/data/tracks/tango_7hz");
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_EQ(dataset->rig.camera.model(), DistortionModel::kFov);
  EXPECT_EQ(dataset->rig.camera.coefficients()[0], 0.932489670230815);
  EXPECT_FALSE(dataset->truth.has_value());
  EXPECT_EQ(dataset->frames.size(), 969u);
}

TEST(Dataset, GivenRealExtrinsicsRoundedInTheFileThenTheRotationIsOrthonormal) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Result<Dataset> dataset = ReadDataset(test::SharedDir() + "/data/euroc/V1_01_easy");
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const Eigen::Matrix3d& rotation = dataset->rig.T_BC.rotation;
  EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_EQ(dataset->imu.front().stamp_ns, 1403715273262142976);
}

}  // namespace
}  // namespace alidade
