#include "eval/truth/refine_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/random.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/simulation/recorded_motion.h"
#include "eval/simulation/simulator.h"
#include "eval/truth/refinement_report.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

/// A simulated sequence on disk whose truth is noisy poses.
class RefineDatasetTest : public ::testing::Test {
 protected:
  void SetUp() override {
    SimulatorConfig config;
    config.duration_s = 8;
    config.path_m = 10.5;
    config.wobble_rad = 0.3;
    config.wobble_hz = 0.5;
    Dataset dataset = Simulate(config, 1).value();
    exact_ = *dataset.truth;
    RandomStream noise(1, "poses");
    for (TrajectoryPoint& point : dataset.truth->points) {
      point.nav.p_WB += 1e-3 * noise.Normal3();
      point.nav.R_WB = point.nav.R_WB * so3::Exp(3e-3 * noise.Normal3());
    }
    dataset.truth->has_velocity = dataset.truth->has_bias = false;
    ASSERT_TRUE(WriteDataset(dataset, folder_.path()).ok());
    folder_.Write("mav0/cam0/data/1.png", "a pixel");
    dataset_ = ReadDataset(folder_.path()).value();
  }

  test::TemporaryFolder folder_;
  Trajectory exact_;
  Dataset dataset_;
};

TEST_F(RefineDatasetTest, WritesASequenceWithATruthThatHasCovariances) {
  const Result<RefinedTruth> refined = RefineDataset(dataset_, {});
  ASSERT_TRUE(refined.ok()) << refined.message();
  const test::TemporaryFolder output;
  ASSERT_TRUE(WriteRefined(dataset_, *refined, output.path()).ok());
  const Result<Dataset> read = ReadDataset(output.path());
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(read->imu.size(), dataset_.imu.size());
  EXPECT_EQ(read->frames.size(), dataset_.frames.size());
  ASSERT_TRUE(read->truth->has_covariance && read->truth->has_velocity && read->truth->has_bias);
  EXPECT_TRUE(std::filesystem::is_symlink(output.File("mav0/cam0/data")));
  EXPECT_TRUE(std::filesystem::exists(output.File("mav0/cam0/data/1.png")));
  // Nearer to the exact motion than the poses were.
  double poses_m = 0, refined_m = 0;
  size_t k = 0;
  for (const TrajectoryPoint& point : read->truth->points) {
    while (exact_.points[k].stamp_ns != point.stamp_ns) {
      ASSERT_LT(++k, exact_.points.size());
    }
    poses_m += (dataset_.truth->points[k].nav.p_WB - exact_.points[k].nav.p_WB).squaredNorm();
    refined_m += (point.nav.p_WB - exact_.points[k].nav.p_WB).squaredNorm();
    EXPECT_LT((point.nav.v_WB - exact_.points[k].nav.v_WB).norm(), 0.05);
  }
  EXPECT_LT(refined_m, 0.8 * poses_m);

  // A simulation along it has a knot at every pose and follows it to a hundredth of the poses' noise.
  SimulatorConfig config;
  const Result<RecordedMotion> motion = LoadRecordedMotion(output.path(), config);
  ASSERT_TRUE(motion.ok()) << motion.message();
  EXPECT_LT(motion->motion.fit().position_rms_m, 1e-5);
}

TEST_F(RefineDatasetTest, GivenScaleFactorsThenTheSamplesAreWrittenWithThem) {
  RefineOptions options;
  options.imu_scale = true;
  Result<RefinedTruth> refined = RefineDataset(dataset_, options);
  ASSERT_TRUE(refined.ok()) << refined.message();
  EXPECT_LT(refined->imu_scale.gyro.cwiseAbs().maxCoeff(), 4 * refined->imu_scale_std.head<3>().maxCoeff());
  EXPECT_THAT(FormatRefinementText(*refined), HasSubstr("scale of the gyroscope"));
  refined->imu_scale.accel.z() = 0.01;
  const test::TemporaryFolder output;
  ASSERT_TRUE(WriteRefined(dataset_, *refined, output.path()).ok());
  const Result<Dataset> read = ReadDataset(output.path());
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_NEAR(read->imu[5].accel.z() / dataset_.imu[5].accel.z(), 1.01, 1e-9);
  EXPECT_EQ(read->rig.imu_noise.gyro_noise_density_radps_sqrthz,
            dataset_.rig.imu_noise.gyro_noise_density_radps_sqrthz);

  options.imu_scale = false;
  const Result<RefinedTruth> as_read = RefineDataset(dataset_, options);
  ASSERT_TRUE(as_read.ok()) << as_read.message();
  EXPECT_TRUE(as_read->imu_scale_std.isZero(0));
  options.imu.noise = ImuNoiseModel::kAdaptive;
  EXPECT_EQ(RefineDataset(dataset_, options).code(), StatusCode::kUsage);
}

TEST_F(RefineDatasetTest, TheReportNamesWhatWasFound) {
  RefineOptions options;
  options.truth_rate_hz = 20;
  options.imu.noise_scale = 2;
  const Result<RefinedTruth> refined = RefineDataset(dataset_, options);
  ASSERT_TRUE(refined.ok()) << refined.message();
  EXPECT_NEAR(static_cast<double>(refined->poses), 160, 2);
  const nlohmann::json json = nlohmann::json::parse(FormatRefinementJson(*refined, dataset_, options));
  EXPECT_EQ(json["truth_rate_hz"], 20);
  EXPECT_EQ(json["constants"]["lever_arm_mm"]["std"].size(), 3u);
  EXPECT_NEAR(json["noise_position_m"]["std"].get<double>(), 1e-3, 2e-4);
  EXPECT_GT(json["fit"]["gyro"]["dof"].get<double>(), 1);
  EXPECT_THAT(FormatRefinementText(*refined), HasSubstr("lever arm of the marker [mm]"));
}

// GIVEN an output that is the dataset, leads to it by a link or lies in it, THEN it is refused and the
// recording stays as it was.
TEST_F(RefineDatasetTest, AnOutputThatIsTheRecordingIsRefused) {
  namespace fs = std::filesystem;
  const std::string imu = test::ReadFile(folder_.File("mav0/imu0/data.csv"));
  const test::TemporaryFolder elsewhere;
  fs::create_directory_symlink(folder_.path(), elsewhere.File("link"));
  fs::create_directories(elsewhere.File("mav_link"));
  fs::create_directory_symlink(folder_.File("mav0"), elsewhere.File("mav_link/mav0"));
  fs::create_directories(elsewhere.File("sensor_link/mav0"));
  fs::create_directory_symlink(folder_.File("mav0/imu0"), elsewhere.File("sensor_link/mav0/imu0"));
  for (const std::string& output :
       {folder_.path(), folder_.path() + "/", folder_.File("mav0/.."), folder_.File("mav0"),
        folder_.File("mav0/new/deep"), elsewhere.File("link"), elsewhere.File("mav_link"),
        elsewhere.File("sensor_link")}) {
    const Status status = WriteRefined(dataset_, RefinedTruth(), output);
    EXPECT_EQ(status.code(), StatusCode::kUsage) << output;
    EXPECT_THAT(status.message(),
                testing::AllOf(HasSubstr("--output: found " + output), HasSubstr("expected another folder")));
  }
  EXPECT_EQ(test::ReadFile(folder_.File("mav0/imu0/data.csv")), imu);
  EXPECT_TRUE(fs::exists(folder_.File("mav0/cam0/data/1.png")));
  EXPECT_FALSE(fs::exists(folder_.File("mav0/new")));
  EXPECT_TRUE(CheckRefinedOutput(dataset_.path, folder_.File("refined")).ok());
  EXPECT_TRUE(CheckRefinedOutput(dataset_.path, elsewhere.File("new")).ok());
  // A dataset within the output's own sequence.
  fs::create_directories(elsewhere.File("outer/mav0"));
  fs::rename(folder_.File("mav0"), elsewhere.File("outer/mav0/mav0"));
  dataset_.path = elsewhere.File("outer/mav0");
  EXPECT_EQ(CheckRefinedOutput(dataset_.path, elsewhere.File("outer")).code(), StatusCode::kUsage);
}

TEST_F(RefineDatasetTest, AnEarlierOutputIsReplaced) {
  namespace fs = std::filesystem;
  const Result<RefinedTruth> refined = RefineDataset(dataset_, {});
  ASSERT_TRUE(refined.ok()) << refined.message();
  const test::TemporaryFolder output;
  output.Write("mav0/cam0/data/old.png", "of a folder, not of a link");
  output.Write("mav0/imu0/data.csv", "old");
  for (int run = 0; run < 2; ++run) {
    const Status written = WriteRefined(dataset_, *refined, output.path());
    ASSERT_TRUE(written.ok()) << written.message();
    EXPECT_TRUE(fs::is_symlink(output.File("mav0/cam0/data")));
    EXPECT_FALSE(fs::exists(output.File("mav0/cam0/data/old.png")));
    EXPECT_TRUE(fs::exists(folder_.File("mav0/cam0/data/1.png")));
    EXPECT_EQ(test::ReadFile(output.File("mav0/imu0/data.csv")),
              test::ReadFile(folder_.File("mav0/imu0/data.csv")));
  }
  for (const auto& entry : fs::recursive_directory_iterator(output.path())) {
    EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".tmp")));
  }
}

TEST_F(RefineDatasetTest, GivenNoPosesThenItIsAnError) {
  dataset_.truth->has_orientation = false;
  EXPECT_THAT(RefineDataset(dataset_, {}).message(), HasSubstr("without orientation"));
  dataset_.truth.reset();
  EXPECT_EQ(RefineDataset(dataset_, {}).code(), StatusCode::kInput);
}

}  // namespace
}  // namespace alidade
