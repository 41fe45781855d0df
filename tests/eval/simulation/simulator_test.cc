#include "eval/simulation/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <set>

#include "eval/simulation/simulator_config.h"

namespace alidade {
namespace {

SimulatorConfig ShortConfig() {
  SimulatorConfig config;
  config.duration_s = 20;
  config.path_m = 26.2;
  return config;
}

/// Every number of a data set, as bytes.
std::string BytesOf(const Dataset& dataset) {
  std::string bytes;
  const auto append = [&bytes](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  for (const ImuSample& sample : dataset.imu) {
    append(&sample.stamp_ns, sizeof sample.stamp_ns);
    append(sample.gyro.data(), sizeof(double) * 3);
    append(sample.accel.data(), sizeof(double) * 3);
  }
  for (const TrackFrame& frame : dataset.frames) {
    append(&frame.stamp_ns, sizeof frame.stamp_ns);
    for (const TrackObservation& observation : frame.observations) {
      append(&observation.track_id, sizeof observation.track_id);
      append(observation.pixel.data(), sizeof(double) * 2);
    }
  }
  for (const TrajectoryPoint& point : dataset.truth->points) {
    append(point.nav.R_WB.data(), sizeof(double) * 9);
    append(point.nav.p_WB.data(), sizeof(double) * 3);
    append(point.nav.v_WB.data(), sizeof(double) * 3);
    append(point.bias.gyro.data(), sizeof(double) * 3);
    append(point.bias.accel.data(), sizeof(double) * 3);
  }
  return bytes;
}

TEST(SimulatorTest, SameConfigAndSeedGiveTheSameBytes) {
  const std::string first = BytesOf(Simulate(ShortConfig(), 5).value());
  EXPECT_EQ(first, BytesOf(Simulate(ShortConfig(), 5).value()));
  EXPECT_NE(first, BytesOf(Simulate(ShortConfig(), 6).value()));
}

TEST(SimulatorTest, SensorsDoNotDisturbEachOther) {
  SimulatorConfig config = ShortConfig();
  const Dataset plain = Simulate(config, 5).value();
  config.outlier_rate = 0.1;
  config.max_features = 50;
  config.camera_rate_hz = 20;
  const Dataset other_camera = Simulate(config, 5).value();
  ASSERT_EQ(plain.imu.size(), other_camera.imu.size());
  for (std::size_t k = 0; k < plain.imu.size(); ++k) {
    ASSERT_EQ(plain.imu[k].gyro, other_camera.imu[k].gyro);
    ASSERT_EQ(plain.imu[k].accel, other_camera.imu[k].accel);
  }
  config = ShortConfig();
  config.imu_rate_hz = 200;
  config.imu_noise.gyro_noise_density_radps_sqrthz = 1e-2;
  const Dataset other_imu = Simulate(config, 5).value();
  ASSERT_EQ(plain.frames.size(), other_imu.frames.size());
  for (std::size_t k = 0; k < plain.frames.size(); ++k) {
    ASSERT_EQ(plain.frames[k].observations.size(), other_imu.frames[k].observations.size());
    for (std::size_t i = 0; i < plain.frames[k].observations.size(); ++i) {
      ASSERT_EQ(plain.frames[k].observations[i].pixel, other_imu.frames[k].observations[i].pixel);
    }
  }
}

TEST(SimulatorTest, OutliersLeaveEveryOtherObservationAsItWas) {
  SimulatorConfig config = ShortConfig();
  const Dataset clean = Simulate(config, 5).value();
  config.outlier_rate = 0.1;
  const Dataset spoiled = Simulate(config, 5).value();
  double changed = 0;
  double count = 0;
  for (std::size_t k = 0; k < clean.frames.size(); ++k) {
    ASSERT_EQ(clean.frames[k].observations.size(), spoiled.frames[k].observations.size());
    for (std::size_t i = 0; i < clean.frames[k].observations.size(); ++i) {
      ASSERT_EQ(clean.frames[k].observations[i].track_id, spoiled.frames[k].observations[i].track_id);
      changed += clean.frames[k].observations[i].pixel == spoiled.frames[k].observations[i].pixel ? 0 : 1;
      count += 1;
    }
  }
  EXPECT_NEAR(changed / count, 0.1, 0.01);
}

TEST(SimulatorTest, StreamsAreAlignedAndComplete) {
  const Dataset dataset = Simulate(ShortConfig(), 5).value();
  ASSERT_EQ(dataset.imu.size(), 2001u);
  ASSERT_EQ(dataset.frames.size(), 201u);
  ASSERT_EQ(dataset.camera_stamps.size(), 201u);
  ASSERT_TRUE(dataset.truth.has_value());
  ASSERT_EQ(dataset.truth->points.size(), 2001u);
  EXPECT_TRUE(dataset.truth->has_velocity);
  EXPECT_TRUE(dataset.truth->has_bias);
  std::set<TimeNs> imu_stamps;
  for (std::size_t k = 0; k < dataset.imu.size(); ++k) {
    EXPECT_EQ(dataset.imu[k].stamp_ns, 1000000000000 + static_cast<TimeNs>(k) * 10000000);
    EXPECT_EQ(dataset.imu[k].stamp_ns, dataset.truth->points[k].stamp_ns);
    imu_stamps.insert(dataset.imu[k].stamp_ns);
  }
  EXPECT_EQ(dataset.frames.front().stamp_ns, dataset.imu.front().stamp_ns);
  for (std::size_t k = 0; k < dataset.frames.size(); ++k) {
    EXPECT_EQ(imu_stamps.count(dataset.frames[k].stamp_ns), 1u);
    EXPECT_EQ(dataset.frames[k].stamp_ns, dataset.camera_stamps[k]);
  }
}

TEST(SimulatorTest, ContradictionsAreConfigurationErrorsThatNameTheKey) {
  struct Case {
    std::function<void(SimulatorConfig&)> spoil;
    std::string key;
  };
  const std::vector<Case> cases = {
      {[](SimulatorConfig& c) { c.rest_s = 19; }, "rest_s"},
      {[](SimulatorConfig& c) { c.landmark_min_distance_m = 11; }, "landmark_min_distance_m"},
      {[](SimulatorConfig& c) { c.camera_lever_arm_m.x() = 3; }, "camera_lever_arm_m"},
      {[](SimulatorConfig& c) { c.distortion_coefficients[0] = 0.1; }, "distortion"},
      {[](SimulatorConfig& c) { c.imu_rate_hz = 0; }, "imu_rate_hz"},
      {[](SimulatorConfig& c) { c.duration_s = -1; }, "duration_s"},
      {[](SimulatorConfig& c) { c.path_m = std::nan(""); }, "path_m"},
      {[](SimulatorConfig& c) { c.distortion = DistortionModel::kFov; }, "camera"},
  };
  for (const Case& one : cases) {
    SimulatorConfig config = ShortConfig();
    one.spoil(config);
    const Result<Dataset> dataset = Simulate(config, 1);
    ASSERT_FALSE(dataset.ok()) << one.key;
    EXPECT_EQ(dataset.code(), StatusCode::kConfig);
    EXPECT_NE(dataset.message().find(one.key), std::string::npos) << dataset.message();
  }
}

}  // namespace
}  // namespace alidade
