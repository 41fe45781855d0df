#include "eval/frontend_run/track_score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWallM = 4;

CameraModel Camera() {
  return CameraModel::Create(DistortionModel::kRadialTangential, {400, 400, 320, 240}, {-0.2, 0.05, 0, 0},
                             640, 480)
      .value();
}

/// The camera moves to the side and turns, before a wall at z = kWallM.
Pose PoseAt(std::size_t frame) {
  const double k = static_cast<double>(frame);
  return {so3::Exp(Vector3d(0.002, -0.003, 0.004) * k), Vector3d(0.05, 0.01, 0) * k};
}

/// Tracks of 12 points of the wall over `count` frames, each `drift` further off a frame.
std::vector<TrackFrame> WallTracks(std::size_t count, const Vector2d& drift) {
  std::vector<TrackFrame> frames(count);
  for (std::size_t k = 0; k < count; ++k) {
    frames[k].stamp_ns = static_cast<TimeNs>(k);
    for (int id = 0; id < 12; ++id) {
      const int row = id / 4;
      const Vector3d p_W(-1.2 + 0.8 * (id % 4), -0.8 + 0.8 * row, kWallM);
      Vector2d pixel;
      EXPECT_TRUE(Camera().Project(PoseAt(k).Inverse() * p_W, &pixel));
      frames[k].observations.push_back({id, pixel + static_cast<double>(k) * drift});
    }
  }
  return frames;
}

TrackTruth WallTruth() {
  TrackTruth truth;
  truth.T_WC = [](const ExposureTime& time) { return std::optional(PoseAt(time.frame)); };
  truth.surface = [](const ExposureTime&, const Vector3d& p_W, const Vector3d& direction_W) {
    return SurfacePoint{p_W + (kWallM - p_W.z()) / direction_W.z() * direction_W, -1};
  };
  return truth;
}

const AgeScore& AtAge(const TrackScore& score, int age) {
  return *std::find_if(score.ages.begin(), score.ages.end(),
                       [&](const AgeScore& row) { return row.age == age; });
}

TEST(TrackScore, GIVEN_tracks_that_end_and_one_with_a_gap_THEN_lives_and_losses_are_counted) {
  std::vector<TrackFrame> frames(4);
  frames[0].observations = {{1, {10, 10}}, {2, {630, 470}}, {3, {11, 11}}};
  frames[1].observations = {{1, {10, 10}}, {2, {630, 470}}};
  frames[2].observations = {{1, {10, 10}}};
  frames[3].observations = {{1, {10, 10}}, {2, {630, 470}}, {4, {12, 12}}};
  const TrackScore score = ScoreTracks(frames, Camera(), {}, {3, 1, 2, 9});
  EXPECT_EQ(score.tracks, 4U);
  EXPECT_EQ(score.censored, 3U);
  EXPECT_DOUBLE_EQ(score.mean_life, (4 + 3 + 1 + 1) / 4.0);
  EXPECT_DOUBLE_EQ(score.median_life, 1);
  EXPECT_DOUBLE_EQ(score.loss_share, 1.0 / 6) << "track 3 alone; track 2 comes back";
  EXPECT_DOUBLE_EQ(score.features_per_frame, 9 / 4.0);
  EXPECT_DOUBLE_EQ(score.coverage, (2 + 2 + 1 + 2) / 4.0 / 48);
  EXPECT_DOUBLE_EQ(score.cpu_ms, 2);
  EXPECT_FALSE(score.has_poses);
}

TEST(TrackScore, GIVEN_exact_tracks_THEN_no_error_is_found) {
  const TrackScore score = ScoreTracks(WallTracks(12, Vector2d::Zero()), Camera(), WallTruth(), {});
  ASSERT_TRUE(score.has_poses && score.has_surface);
  EXPECT_EQ(score.corner.count, 12U * 11);
  EXPECT_LT(score.corner.p95_px, 1e-6);
  EXPECT_LT(score.epipolar.p95_px, 1e-6);
  EXPECT_EQ(AtAge(score, 10).observations, 12U);
  EXPECT_TRUE(std::isnan(score.cpu_ms)) << "not measured";
}

TEST(TrackScore, GIVEN_a_drift_THEN_errors_grow_with_age_as_it_does) {
  const Vector2d drift(0.03, -0.04);
  const TrackScore score = ScoreTracks(WallTracks(12, drift), Camera(), WallTruth(), {});
  EXPECT_NEAR(AtAge(score, 1).corner.median_px, 0.05, 1e-6);
  EXPECT_NEAR(AtAge(score, 10).corner.median_px, 0.5, 1e-6);
  // Sampson's distance is shared by both images and lacks what lies along the line.
  EXPECT_GT(AtAge(score, 10).epipolar.median_px, 0.1);
  EXPECT_LT(AtAge(score, 10).epipolar.median_px, 0.5);
}

TEST(TrackScore, GIVEN_noise_ratios_THEN_errors_are_told_by_their_spans) {
  std::vector<TrackFrame> frames = WallTracks(12, Vector2d::Zero());
  for (std::size_t k = 1; k < frames.size(); ++k) {
    for (TrackObservation& observation : frames[k].observations) {
      if (observation.track_id < 4) {
        observation.noise_ratio = 2.5;
        observation.pixel.x() += 0.3;
      } else if (observation.track_id == 4) {
        observation.noise_ratio = 0.5;
      }
    }
  }
  const TrackScore score = ScoreTracks(frames, Camera(), WallTruth(), {});
  const auto span = [&](double from) {
    return *std::find_if(score.ratios.begin(), score.ratios.end(),
                         [from](const RatioScore& ratio) { return ratio.from == from; });
  };
  EXPECT_EQ(span(2).observations, 4U * 11);
  EXPECT_NEAR(span(2).corner.median_px, 0.3, 1e-6);
  EXPECT_EQ(span(0).observations, 8U * 11) << "with those below 1.25, and those below 1";
  EXPECT_LT(span(0).corner.p95_px, 1e-6);
  EXPECT_EQ(span(5).observations, 0U);
}

TEST(TrackScore, GIVEN_a_rolling_shutter_THEN_each_row_is_judged_at_its_own_time) {
  // A row is exposed 0.4 / 480 of a frame after the one above it.
  constexpr double kDelay = 0.4 / 480;
  const auto pose_at = [](const ExposureTime& time) {
    const double k = static_cast<double>(time.frame) + kDelay * (time.row - 240);
    return Pose{so3::Exp(Vector3d(0.002, -0.003, 0.004) * k), Vector3d(0.05, 0.01, 0) * k};
  };
  std::vector<TrackFrame> frames = WallTracks(12, Vector2d::Zero());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (TrackObservation& observation : frames[k].observations) {
      const int id = static_cast<int>(observation.track_id);
      const int row = id / 4;
      const Vector3d p_W(-1.2 + 0.8 * (id % 4), -0.8 + 0.8 * row, kWallM);
      for (int round = 0; round < 30; ++round) {
        const Pose T_WC = pose_at({k, observation.pixel.y()});
        ASSERT_TRUE(Camera().Project(T_WC.Inverse() * p_W, &observation.pixel));
      }
    }
  }
  EXPECT_GT(ScoreTracks(frames, Camera(), WallTruth(), {}).corner.p95_px, 0.01) << "as if all at once";
  TrackTruth truth = WallTruth();
  truth.T_WC = [&](const ExposureTime& time) { return std::optional(pose_at(time)); };
  const TrackScore score = ScoreTracks(frames, Camera(), truth, {});
  EXPECT_EQ(score.corner.count, 12U * 11);
  EXPECT_LT(score.corner.p95_px, 1e-3);
  EXPECT_LT(score.epipolar.p95_px, 1e-6);
}

TEST(TrackScore, GIVEN_a_wall_that_moves_THEN_its_points_move_along_and_are_counted) {
  TrackTruth truth = WallTruth();
  const Vector3d step(0.01, 0, 0);
  truth.surface = [&](const ExposureTime& time, const Vector3d& p_W, const Vector3d& direction_W) {
    SurfacePoint point = WallTruth().surface(time, p_W, direction_W);
    point.moving = point.p_W.x() < 0 ? 3 : -1;
    return point;
  };
  truth.moved = [&](const SurfacePoint& point, const ExposureTime& seen,
                    const ExposureTime& time) -> Vector3d {
    const double k = static_cast<double>(time.frame) - static_cast<double>(seen.frame);
    return point.moving == 3 ? point.p_W + k * step : point.p_W;
  };
  const TrackScore score = ScoreTracks(WallTracks(12, Vector2d::Zero()), Camera(), truth, {});
  EXPECT_DOUBLE_EQ(score.moving_share, 0.5) << "six of twelve points are left of the middle";
  EXPECT_NEAR(AtAge(score, 1).corner.p95_px, 1, 0.2) << "400 px / 4 m * 0.01 m; they stay where they were";
  EXPECT_NEAR(AtAge(score, 1).corner.median_px, 0, 1e-6);
}

TEST(TrackScore, GIVEN_a_camera_that_only_turns_THEN_there_is_no_epipolar_error) {
  TrackTruth truth = WallTruth();
  truth.T_WC = [](const ExposureTime& time) {
    return std::optional(Pose{PoseAt(time.frame).rotation, Vector3d::Zero()});
  };
  EXPECT_EQ(ScoreTracks(WallTracks(3, Vector2d::Zero()), Camera(), truth, {}).epipolar.count, 0U);
}

TEST(TrackScore, GIVEN_frames_without_truth_THEN_only_the_others_are_judged) {
  TrackTruth truth = WallTruth();
  truth.T_WC = [](const ExposureTime& time) {
    return time.frame == 0 || time.frame == 5 ? std::nullopt : std::optional(PoseAt(time.frame));
  };
  std::vector<TrackFrame> frames = WallTracks(6, Vector2d::Zero());
  EXPECT_EQ(ScoreTracks(frames, Camera(), truth, {}).corner.count, 0U) << "every track began without truth";
  for (TrackObservation& observation : frames[0].observations) {
    observation.track_id += 100;
  }
  std::sort(frames[0].observations.begin(), frames[0].observations.end(),
            [](const TrackObservation& a, const TrackObservation& b) { return a.track_id < b.track_id; });
  EXPECT_EQ(ScoreTracks(frames, Camera(), truth, {}).corner.count, 12U * 3);
}

TEST(TrackScore, GIVEN_no_frame_THEN_the_texts_say_nothing_instead_of_zero) {
  const TrackScore score = ScoreTracks({}, Camera(), {}, {});
  const nlohmann::json json = nlohmann::json::parse(ScoreJson(score));
  EXPECT_TRUE(json["mean_life_frames"].is_null());
  EXPECT_TRUE(json["corner"].is_null());
  EXPECT_EQ(json["tracks"], 0);
}

TEST(TrackScore, GIVEN_a_score_THEN_json_and_csv_hold_its_figures) {
  const TrackScore score = ScoreTracks(WallTracks(12, {0.03, -0.04}), Camera(), WallTruth(), {1.5});
  const nlohmann::json json = nlohmann::json::parse(ScoreJson(score));
  EXPECT_DOUBLE_EQ(json["mean_life_frames"], 12);
  EXPECT_DOUBLE_EQ(json["cpu_ms"], 1.5);
  EXPECT_NEAR(json["ages"][3]["corner"]["median_px"], 0.5, 1e-6);
  const std::string csv = ScoreCsv(score);
  EXPECT_EQ(
      csv.substr(0, csv.find('\n')),
      "age,observations,epipolar_count,epipolar_median_px,epipolar_p95_px,corner_count,corner_median_px,"
      "corner_p95_px");
  EXPECT_NE(csv.find("\n30,0,0,,,0,,\n"), std::string::npos) << csv;
  EXPECT_NE(DescribeScore(score).find("12 tracks (12 alive at the end)"), std::string::npos);
}

}  // namespace
}  // namespace alidade
