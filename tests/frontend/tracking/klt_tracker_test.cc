#include "frontend/tracking/klt_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "tests/frontend/tracking/synthetic_scene.h"
#include "tests/frontend/tracking/track_images.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::FeedRotation;
using test::kFrameNs;
using test::kHeightPx;
using test::kWidthPx;
using test::Median;
using test::MustTrack;
using test::Render;
using test::TestRig;
using test::Wall;
using test::WithoutImu;

std::map<std::int64_t, Vector2d> ById(const TrackFrame& frame) {
  std::map<std::int64_t, Vector2d> pixels;
  for (const TrackObservation& observation : frame.observations) {
    pixels[observation.track_id] = observation.pixel;
  }
  return pixels;
}

/// Distance [px] of each common track's second position from where `moved` takes its first.
std::vector<double> Errors(const TrackFrame& first, const TrackFrame& second,
                           const std::function<Vector2d(const Vector2d&)>& moved) {
  const std::map<std::int64_t, Vector2d> before = ById(first);
  std::vector<double> errors;
  for (const auto& [id, pixel] : ById(second)) {
    if (before.contains(id)) {
      errors.push_back((pixel - moved(before.at(id))).norm());
    }
  }
  return errors;
}

TEST(KltTracker, FollowsATranslatedImageToATenthOfAPixel) {
  KltTracker tracker(WithoutImu(), TestRig());
  const Vector2d step(3.3, -2.7);
  TrackFrame first = MustTrack(&tracker, 0, Render(kWidthPx, kHeightPx, [](const Vector2d& u) { return u; }));
  ASSERT_GE(first.observations.size(), 140U);
  const TrackFrame second =
      MustTrack(&tracker, kFrameNs,
                Render(kWidthPx, kHeightPx, [&](const Vector2d& u) -> Vector2d { return u - step; }));
  const std::vector<double> errors =
      Errors(first, second, [&](const Vector2d& u) -> Vector2d { return u + step; });
  EXPECT_GE(errors.size(), 120U);
  EXPECT_LT(Median(errors), 0.1);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.7);
}

// GIVEN a near surface that moves in front of a far one at rest, WHEN a patch shows both THEN its observation
// gets a larger noise ratio, and has a larger error.
TEST(KltTracker, ObservationsOfTwoSurfacesHaveALargerNoiseRatio) {
  KltTracker tracker(WithoutImu(), TestRig());
  const double edge_px = 0.5 * kWidthPx;
  const Vector2d step(0.8, 0.3);
  std::map<std::int64_t, Vector2d> began;
  double sure_px = 0, unsure_px = 0, sure = 0, unsure = 0;
  for (int k = 0; k < 8; ++k) {
    const double shift = k * step.x();
    const TrackFrame frame =
        MustTrack(&tracker, k * kFrameNs, Render(kWidthPx, kHeightPx, [&](const Vector2d& u) -> Vector2d {
          return u.x() < edge_px + shift ? u - k * step : Vector2d(u.x() + 5000, u.y());
        }));
    for (const TrackObservation& seen : frame.observations) {
      const auto [place, is_new] = began.try_emplace(seen.track_id, seen.pixel - k * step);
      if (is_new) {
        EXPECT_EQ(seen.noise_ratio, 1);
      } else if (place->second.x() < edge_px) {
        const bool is_sure = seen.noise_ratio < 1.5;
        (is_sure ? sure_px : unsure_px) += (seen.pixel - k * step - place->second).squaredNorm();
        (is_sure ? sure : unsure) += 1;
      }
    }
  }
  ASSERT_GT(sure, 300);
  ASSERT_GT(unsure, 5);
  EXPECT_GT(sure, 10 * unsure);
  EXPECT_GT(std::sqrt(unsure_px / unsure), 3 * std::sqrt(sure_px / sure));
}

TEST(KltTracker, WithoutTemplatesAllNoiseRatiosAreOne) {
  FrontendConfig config = WithoutImu();
  config.template_px = 0;
  KltTracker tracker(config, TestRig());
  for (int k = 0; k < 4; ++k) {
    const TrackFrame frame = MustTrack(
        &tracker, k * kFrameNs,
        Render(kWidthPx, kHeightPx, [k](const Vector2d& u) -> Vector2d { return u - k * Vector2d(2, 1); }));
    for (const TrackObservation& seen : frame.observations) {
      EXPECT_EQ(seen.noise_ratio, 1);
    }
  }
}

TEST(KltTracker, FollowsAHomographyOverTenFrames) {
  KltTracker tracker(WithoutImu(), TestRig());
  Matrix3d step = Matrix3d::Identity();  // one degree about the centre, 1 % larger, slightly tilted, shifted
  const Vector2d centre(kWidthPx / 2, kHeightPx / 2);
  step.topLeftCorner<2, 2>() = 1.01 * Eigen::Rotation2Dd(0.0175).toRotationMatrix();
  step.topRightCorner<2, 1>() = centre - step.topLeftCorner<2, 2>() * centre + Vector2d(1.5, -0.8);
  step.bottomLeftCorner<1, 2>() << 1e-6, -2e-6;
  Matrix3d homography = Matrix3d::Identity();
  TrackFrame first;
  for (int k = 0; k <= 10; ++k) {
    const Matrix3d inverse = homography.inverse();
    const TrackFrame frame =
        MustTrack(&tracker, k * kFrameNs, Render(kWidthPx, kHeightPx, [&](const Vector2d& u) -> Vector2d {
          return (inverse * u.homogeneous()).hnormalized();
        }));
    if (k == 0) {
      first = frame;
      homography = step * homography;
      continue;
    }
    const std::vector<double> errors = Errors(first, frame, [&](const Vector2d& u) -> Vector2d {
      return (homography * u.homogeneous()).hnormalized();
    });
    EXPECT_GE(errors.size(), 60U) << "frame " << k;
    // Without templates turning and growing pull a patch aside by a few hundredths each frame, and it adds
    // up.
    EXPECT_LT(Median(errors), 0.1) << "frame " << k;
    homography = step * homography;
  }
  EXPECT_GT(tracker.statistics().mean_track_length, 5);
}

/// Turns by `angle_deg` a frame about a tilted axis and counts the tracks that end where they should.
int CorrectTracksWhenTurning(double angle_deg, bool with_gyro, double camera_time_offset_s) {
  RigCalibration rig = TestRig();
  rig.camera_time_offset_s = camera_time_offset_s;
  FrontendConfig config;
  config.pyramid_levels = 2;
  KltTracker tracker(config, rig);
  const Wall wall(rig.camera, 1.0);
  const Matrix3d R_step = so3::Exp(Vector3d(0.3, 1.0, 0.4).normalized() * angle_deg * M_PI / 180);
  const Pose before{.rotation = so3::Exp({0, -0.05, 0}), .translation = Vector3d::Zero()};
  const Pose after{.rotation = before.rotation * R_step, .translation = Vector3d::Zero()};
  const TrackFrame first = MustTrack(&tracker, 0, wall.Image(before));
  if (with_gyro) {
    FeedRotation(&tracker, rig, R_step, SecondsToNs(camera_time_offset_s));
  }
  const TrackFrame second = MustTrack(&tracker, kFrameNs, wall.Image(after));
  const std::vector<double> errors = Errors(first, second, [&](const Vector2d& u) -> Vector2d {
    Vector2d moved(-1e3, -1e3);
    wall.Transfer(u, before, after, &moved);
    return moved;
  });
  return static_cast<int>(std::count_if(errors.begin(), errors.end(), [](double e) { return e < 1.0; }));
}

TEST(KltTracker, GyroscopeCarriesTracksThroughATurnThatLosesThemWithout) {
  EXPECT_GE(CorrectTracksWhenTurning(7.0, true, 0.0), 80);
  EXPECT_LE(CorrectTracksWhenTurning(7.0, false, 0.0), 10);
}

TEST(KltTracker, GyroscopeIsReadAtTheCamerasTimeOffset) {
  EXPECT_GE(CorrectTracksWhenTurning(7.0, true, 3.0), 80);
  EXPECT_GE(CorrectTracksWhenTurning(7.0, true, -3.0), 80);
}

TEST(KltTracker, RejectsARegionThatMovesOnItsOwn) {
  const RigCalibration rig = TestRig();
  const Wall wall(rig.camera, 4.0);
  const Pose before;
  const Pose after{.rotation = so3::Exp({0.002, -0.003, 0.004}), .translation = {0.10, 0.0, 0.02}};
  // A block of the image is pasted from another part of the texture and moves down, across the epipolar
  // lines.
  const auto in_block = [](const Vector2d& u) {
    return u.x() > 430 && u.x() < 640 && u.y() > 130 && u.y() < 330;
  };
  const auto paste = [&](std::vector<unsigned char> image, double shift_px) {
    for (int row = 130; row < 330; ++row) {
      for (int column = 430; column < 640; ++column) {
        image[static_cast<size_t>(row * kWidthPx + column)] =
            test::Texture(Vector2d(column + 5000, row - shift_px + 5000));
      }
    }
    return image;
  };
  KltTracker tracker({}, rig);
  MustTrack(&tracker, 0, paste(wall.Image(before), 0));
  // Without the rotation nothing is wrong here: two planes that move apart fit some fundamental matrix.
  FeedRotation(&tracker, rig, after.rotation, 0);
  const TrackFrame second = MustTrack(&tracker, kFrameNs, paste(wall.Image(after), 6));
  const std::int64_t first_new = second.observations.back().track_id - tracker.statistics().detected + 1;
  int inside = 0;
  int outside = 0;
  for (const TrackObservation& observation : second.observations) {
    if (observation.track_id < first_new) {
      ++(in_block(observation.pixel) ? inside : outside);
    }
  }
  EXPECT_LE(inside, 1);
  EXPECT_GE(outside, 80);
  EXPECT_GE(tracker.statistics().rejected, 8);
}

TEST(KltTracker, BackwardPassAndTemplateEachLoseTracksWhoseTextureIsCovered) {
  const std::vector<unsigned char> before = Render(kWidthPx, kHeightPx, [](const Vector2d& u) { return u; });
  // Something else comes to stand before the right half.
  const std::vector<unsigned char> after = Render(kWidthPx, kHeightPx, [](const Vector2d& u) -> Vector2d {
    return u.x() > 0.5 * kWidthPx ? Vector2d(u + Vector2d(3000, 4000)) : u;
  });
  const auto wrong_tracks = [&](double forward_backward_px, int template_px) {
    FrontendConfig config = WithoutImu();
    config.forward_backward_px = forward_backward_px;
    config.template_px = template_px;
    config.ransac_threshold_px = 20;  // out of the way
    KltTracker tracker(config, TestRig());
    const TrackFrame first = MustTrack(&tracker, 0, before);
    const TrackFrame second = MustTrack(&tracker, kFrameNs, after);
    const std::map<std::int64_t, Vector2d> start = ById(first);
    return std::count_if(
        second.observations.begin(), second.observations.end(), [&](const TrackObservation& o) {
          return start.contains(o.track_id) && start.at(o.track_id).x() > 0.5 * kWidthPx + 15;
        });
  };
  EXPECT_LE(wrong_tracks(0.5, 0), 12);
  EXPECT_LE(wrong_tracks(0, 13), 12);
  EXPECT_GE(wrong_tracks(0, 0), 30);
}

/// Tracks of the first image that are left after 11 images, the image moving by (1.5, -1) px each time, and
/// how far they are off, median. image(k): the k-th without its motion.
std::pair<int, double> LeftAfterTen(const FrontendConfig& config,
                                    const std::function<double(int k, const Vector2d& u)>& image) {
  KltTracker tracker(config, TestRig());
  TrackFrame first, frame;
  for (int k = 0; k <= 10; ++k) {
    std::vector<unsigned char> pixels;
    for (int row = 0; row < kHeightPx; ++row) {
      for (int column = 0; column < kWidthPx; ++column) {
        const double grey = image(k, Vector2d(column - 1.5 * k, row + k));
        pixels.push_back(static_cast<unsigned char>(std::clamp(grey, 0.0, 255.0)));
      }
    }
    frame = MustTrack(&tracker, k * kFrameNs, pixels);
    first = k == 0 ? frame : first;
  }
  const std::vector<double> errors =
      Errors(first, frame, [](const Vector2d& u) -> Vector2d { return u + Vector2d(15, -10); });
  return {static_cast<int>(errors.size()), Median(errors)};
}

TEST(KltTracker, GIVEN_an_exposure_that_changes_THEN_tracks_stay_in_place) {
  const auto [left, error_px] = LeftAfterTen(WithoutImu(), [](int k, const Vector2d& u) {
    const double gain = 1 + 0.35 * std::sin(0.6 * k);
    return 20 + gain * 0.6 * test::Texture(u);
  });
  EXPECT_GE(left, 100);
  EXPECT_LT(error_px, 0.1);
}

TEST(KltTracker, GIVEN_a_texture_that_changes_slowly_THEN_tracks_outlive_their_templates) {
  const auto left = [](double min_correlation) {
    FrontendConfig config = WithoutImu();
    config.min_correlation = min_correlation;
    return LeftAfterTen(config,
                        [](int k, const Vector2d& u) {
                          const double share = 0.06 * k;
                          return (1 - share) * test::Texture(u) +
                                 share * test::Texture(u + Vector2d(3000, 4000));
                        })
        .first;
  };
  // In the end two thirds of the patch is another one.
  EXPECT_GE(left(0.95), 60);
  EXPECT_GE(left(0.95), left(0.0) / 2);
}

}  // namespace
}  // namespace alidade
