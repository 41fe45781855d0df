#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>

#include "eval/dataset/dataset_reader.h"
#include "tests/frontend/initialization/initializer_scenario.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

using test::StartAt;
using test::StartOutcome;

/// Reads a sequence; one with camera stamps or images alone gets frames without tracks.
Dataset ReadSequence(const std::string& name) {
  Result<Dataset> dataset = ReadDataset(test::SharedDir() + "/data/" + name);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  if (!dataset.ok()) {
    return {};
  }
  if (dataset->frames.empty()) {
    for (const TimeNs stamp : dataset->camera_stamps) {
      dataset.value().frames.push_back({stamp, {}, 0});
    }
    for (const ImageEntry& image : dataset->images) {
      dataset.value().frames.push_back({image.stamp_ns, {}, 0});
    }
  }
  return *std::move(dataset);
}

StartOutcome AutoStart(const Dataset& dataset, double at_s, double accel_bias_std_mps2) {
  EstimatorConfig config;
  config.init.method = InitMethod::kAuto;
  config.init.accel_bias_std_mps2 = accel_bias_std_mps2;
  StartOutcome outcome = StartAt(config, dataset, dataset.frames.front().stamp_ns + SecondsToNs(at_s), 12);
  std::cout << "  " << dataset.name << " + " << at_s << " s: " << outcome.method << " after "
            << outcome.waited_s << " s, tilt error " << outcome.tilt_error_rad << " rad, velocity error "
            << outcome.velocity_error_mps << " m/s, scale error " << outcome.scale_error << "; "
            << outcome.message << "\n";
  return outcome;
}

class RestingStart : public testing::TestWithParam<std::string> {};

TEST_P(RestingStart, THEN_the_static_way_finds_gravity_and_the_gyro_bias) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Dataset dataset = ReadSequence(GetParam());
  ASSERT_FALSE(dataset.frames.empty());
  const StartOutcome outcome = AutoStart(dataset, 0, 0.1);
  ASSERT_TRUE(outcome.ok) << outcome.message;
  EXPECT_EQ(outcome.method, "static");
  EXPECT_LT(outcome.waited_s, 4);
  // The vehicles' gyroscope: about (-0.002, 0.021..0.024, 0.077..0.083) rad/s by their truth files.
  EXPECT_LT((outcome.estimate.bias.gyro - Eigen::Vector3d(-0.002, 0.0225, 0.0795)).norm(), 0.006);
  // V1_01's truth orientation is 2.7 deg off gravity (the data's documentation).
  EXPECT_LT(outcome.tilt_error_rad, 0.06);
}

INSTANTIATE_TEST_SUITE_P(EuRoC, RestingStart,
                         testing::Values("euroc_micro/V1_01_first95", "euroc/V1_01_easy", "euroc/V2_01_easy",
                                         "tracks/euroc_v1_01_keyframes"),
                         [](const testing::TestParamInfo<std::string>& tested) {
                           std::string name = tested.param;
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

TEST(RealStart, GIVEN_sparse_keyframes_in_flight_THEN_the_dynamic_way_finds_the_scale) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Dataset dataset = ReadSequence("tracks/euroc_v1_01_keyframes");
  ASSERT_FALSE(dataset.frames.empty());
  for (const double at_s : {20.0, 60.0, 80.0}) {
    const StartOutcome outcome = AutoStart(dataset, at_s, 0.1);
    ASSERT_TRUE(outcome.ok) << outcome.message;
    EXPECT_EQ(outcome.method, "dynamic");
    EXPECT_LT(outcome.scale_error, 0.08);
    EXPECT_LT(outcome.velocity_error_mps, 0.1);
  }
}

TEST(RealStart,
     GIVEN_a_wide_phone_camera_THEN_rest_is_taken_statically_and_motion_finds_the_large_accel_bias) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Dataset dataset = ReadSequence("tracks/tango_7hz");
  ASSERT_FALSE(dataset.frames.empty());
  const StartOutcome rest = AutoStart(dataset, 0, 0.5);
  ASSERT_TRUE(rest.ok) << rest.message;
  EXPECT_EQ(rest.method, "static");
  for (const double at_s : {8.0, 16.0, 40.0}) {
    const StartOutcome moving = AutoStart(dataset, at_s, 0.5);
    ASSERT_TRUE(moving.ok) << moving.message;
    EXPECT_EQ(moving.method, "dynamic");
    // An independent batch estimate of this recording has (-0.42, -0.40, 0.73) m/s^2.
    EXPECT_LT((moving.estimate.bias.accel - Eigen::Vector3d(-0.42, -0.40, 0.73)).norm(), 0.3);
  }
}

}  // namespace
}  // namespace alidade
