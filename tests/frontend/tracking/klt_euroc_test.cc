#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "frontend/tracking/image_reader.h"
#include "frontend/tracking/klt_tracker.h"
#include "tests/frontend/tracking/synthetic_scene.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

using Eigen::Vector2d;

/// EuRoC V1_01's left camera as its sensor.yaml states it.
RigCalibration EurocRig() {
  RigCalibration rig;
  rig.camera = CameraModel::Create(DistortionModel::kRadialTangential, {458.654, 457.296, 367.215, 248.375},
                                   {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}, 752, 480)
                   .value();
  Eigen::Matrix3d R_BC;
  R_BC << 0.0148655429818, -0.999880929698, 0.00414029679422, 0.999557249008, 0.0149672133247, 0.025715529948,
      -0.0257744366974, 0.00375618835797, 0.999660727178;
  rig.T_BC.rotation = so3::Normalize(R_BC);
  rig.T_BC.translation = {-0.0216401454975, -0.064676986768, 0.00981073058949};
  return rig;
}

std::vector<ImuSample> ReadImu(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<ImuSample> samples;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') {
      continue;
    }
    std::replace(line.begin(), line.end(), ',', ' ');
    ImuSample sample;
    std::istringstream(line) >> sample.stamp_ns >> sample.gyro.x() >> sample.gyro.y() >> sample.gyro.z();
    samples.push_back(sample);
  }
  return samples;
}

TEST(KltTrackerOnEuroc, TracksSurviveAtRest) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::filesystem::path folder =
      std::filesystem::path(test::SharedDir()) / "data/euroc_micro/V1_01_first95/mav0";
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cam0/data")) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  ASSERT_EQ(paths.size(), 95U);
  const std::vector<ImuSample> imu = ReadImu(folder / "imu0/data.csv");
  ASSERT_GT(imu.size(), 1000U);

  const FrontendConfig config;
  KltTracker tracker(config, EurocRig());
  std::map<std::int64_t, Vector2d> start;
  std::map<std::int64_t, Vector2d> last;
  std::vector<double> motion_px;
  std::vector<double> drift_px;
  int rejected = 0;
  double sum_ms = 0;
  TrackFrame frame;
  auto next_imu = imu.begin();
  for (const std::filesystem::path& path : paths) {
    const TimeNs stamp_ns = std::stoll(path.stem().string());
    for (; next_imu != imu.end() && next_imu->stamp_ns <= stamp_ns; ++next_imu) {
      tracker.AddImu(*next_imu);
    }
    const Result<GreyImage> image = ReadGreyImage(path.string());
    ASSERT_TRUE(image.ok()) << image.message();
    Result<TrackFrame> tracked =
        tracker.Track(stamp_ns, image->pixels.data(), image->width_px, image->height_px);
    ASSERT_TRUE(tracked.ok()) << tracked.message();
    frame = *tracked;
    rejected += tracker.statistics().rejected;
    sum_ms += frame.frontend_ms;
    std::map<std::int64_t, Vector2d> now;
    for (const TrackObservation& observation : frame.observations) {
      now[observation.track_id] = observation.pixel;
      start.try_emplace(observation.track_id, observation.pixel);
      if (last.contains(observation.track_id)) {
        motion_px.push_back((observation.pixel - last[observation.track_id]).norm());
      }
    }
    last = now;
  }
  std::set<int> cells;
  // The vehicle tilts by 4 mrad as its rotors start: what the image has in common is motion, the rest is
  // drift.
  std::vector<double> right_px;
  std::vector<double> down_px;
  for (const auto& [id, pixel] : last) {
    right_px.push_back((pixel - start[id]).x());
    down_px.push_back((pixel - start[id]).y());
  }
  const Vector2d common_px(test::Median(right_px), test::Median(down_px));
  for (const auto& [id, pixel] : last) {
    drift_px.push_back((pixel - start[id] - common_px).norm());
    cells.insert(static_cast<int>(pixel.y()) * config.grid_rows / 480 * config.grid_columns +
                 static_cast<int>(pixel.x()) * config.grid_columns / 752);
  }
  const double mean_length = tracker.statistics().mean_track_length;
  std::cout << "features " << last.size() << ", cells " << cells.size() << ", mean length " << mean_length
            << " of 95, tracks ever " << start.size() << ", rejected " << rejected << ", median motion "
            << test::Median(motion_px) << " px a frame, " << test::Median(drift_px)
            << " px drift since first seen, " << sum_ms / 95 << " ms a frame\n";
  EXPECT_GE(last.size(), 120U);
  EXPECT_GE(cells.size(), 30U);
  EXPECT_GT(mean_length, 60);
  EXPECT_LT(test::Median(motion_px), 0.5);
  EXPECT_LT(test::Median(drift_px), 0.5);
}

}  // namespace
}  // namespace alidade
