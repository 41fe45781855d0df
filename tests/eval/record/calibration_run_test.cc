#include <gtest/gtest.h>

#include <filesystem>

#include "eval/record/recorder.h"
#include "eval/record/recorder_reader.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/record/estimator_runs.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

SimulatorConfig Miscalibrated(double duration_s) {
  SimulatorConfig config;
  config.duration_s = duration_s;
  config.path_m = 1.31 * duration_s;
  config.wobble_rad = 0.2;
  config.wobble_hz = 0.5;
  config.calibration_rotation_error_rad = 0.035;
  config.calibration_translation_error_m = 0.02;
  config.calibration_time_error_s = 0.01;
  return config;
}

EstimatorConfig Calibrating(Backend backend) {
  EstimatorConfig config = test::CarryingEstimator(backend);
  config.calibration.extrinsics = config.calibration.time_offset = true;
  return config;
}

RunResult RunOn(const EstimatorConfig& config, const Dataset& dataset) {
  return test::RunOn(config, dataset, 101);
}

/// Largest error of a coordinate in its own standard deviations.
double WorstSigma(const CalibrationEstimate& estimate, const RigCalibration& truth) {
  const Eigen::VectorXd error =
      Local(estimate.layout, estimate.mean, {truth.camera, truth.T_BC, truth.camera_time_offset_s});
  return error.cwiseQuotient(estimate.deviations).cwiseAbs().maxCoeff();
}

class CalibrationRunTest : public testing::TestWithParam<Backend> {};

// GIVEN a camera 2 degrees, 2 cm and 10 ms off, WHEN it is calibrated online for twenty seconds, THEN
// rotation and time offset are right, position is on its way, and the deviations state how far each is.
TEST_P(CalibrationRunTest, FindsAWrongCamera) {
  const Result<Dataset> dataset = Simulate(Miscalibrated(20), 101);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const RunResult result = RunOn(Calibrating(GetParam()), *dataset);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  ASSERT_TRUE(result.calibration_error.has_value());
  EXPECT_LT(result.calibration_error->rotation_rad, 0.3 * M_PI / 180);
  EXPECT_LT(result.calibration_error->time_offset_s, 1e-3);
  EXPECT_LT(result.calibration_error->translation_m, 0.02);
  EXPECT_LT(WorstSigma(*result.records.back().calibration, *dataset->true_rig), 4.5);
  EXPECT_TRUE(result.restarts.empty());
}

// GIVEN focal lengths and principal point 8 px off, WHEN they are calibrated, THEN they come closer and
// within the deviations.
TEST_P(CalibrationRunTest, FindsWrongIntrinsics) {
  SimulatorConfig simulation = Miscalibrated(20);
  simulation.calibration_rotation_error_rad = simulation.calibration_translation_error_m = 0;
  simulation.calibration_time_error_s = 0;
  simulation.calibration_focal_error_px = simulation.calibration_center_error_px = 8;
  const Result<Dataset> dataset = Simulate(simulation, 102);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EstimatorConfig config = Calibrating(GetParam());
  config.calibration.extrinsics = config.calibration.time_offset = false;
  config.calibration.intrinsics = true;
  config.smoother.landmark = SmootherLandmark::kPoseOnly;  // the other one finds the same, far slower
  config.calibration.focal_std_px = config.calibration.center_std_px = 8;
  const RunResult result = RunOn(config, *dataset);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  ASSERT_TRUE(result.calibration_error.has_value());
  EXPECT_LT(result.calibration_error->focal_px, 2);
  EXPECT_LT(WorstSigma(*result.records.back().calibration, *dataset->true_rig), 4.5);
}

TEST_P(CalibrationRunTest, WritesItsCourse) {
  const Result<Dataset> dataset = Simulate(Miscalibrated(3), 103);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const EstimatorConfig config = Calibrating(GetParam());
  const RunResult result = RunOn(config, *dataset);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  const test::TemporaryFolder folder;
  const RunIdentity identity{config, "walk", "d", "i", 101, dataset->imu.size(), dataset->frames.size()};
  ASSERT_TRUE(WriteRun(identity, result, folder.path()).ok());
  const std::string text = test::ReadFile(folder.path() + "/calibration.csv");
  EXPECT_EQ(
      text.substr(0, text.find('\n')),
      "timestamp_ns,q_w,q_x,q_y,q_z,p_x,p_y,p_z,time_offset_s,std_phi_x,std_phi_y,std_phi_z,std_p_x,std_p_y,"
      "std_p_z,std_time_offset_s");
  EXPECT_EQ(static_cast<size_t>(std::count(text.begin(), text.end(), '\n')), result.records.size() + 1);
  const Result<RunResult> read = ReadRun(folder.path());
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_TRUE(read->calibration_error.has_value());
  EXPECT_EQ(read->calibration_error->rotation_rad, result.calibration_error->rotation_rad);
}

TEST(CalibrationRunTest, IsRefusedWhereItIsNotEstimated) {
  EstimatorConfig config = Calibrating(Backend::kBatch);
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
  config.backend = Backend::kSmoother;
  EXPECT_TRUE(config.Validate().ok());
  config.backend = Backend::kFilter;
  EXPECT_TRUE(config.Validate().ok());
}

INSTANTIATE_TEST_SUITE_P(Backends, CalibrationRunTest, testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& param) { return std::string(ToString(param.param)); });

}  // namespace
}  // namespace alidade
