#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/navigation_state.h"
#include "core/track_frame.h"

namespace alidade {

/// Of errors in pixels; NaN of none.
struct ErrorSpread {
  std::size_t count = 0;
  double median_px = 0;
  double p95_px = 0;
};

/// Tracks at one age: the number of frames since their first observation.
struct AgeScore {
  int age = 0;
  std::size_t observations = 0;
  ErrorSpread epipolar;
  ErrorSpread corner;
};

/// Observations of one span of noise_ratio, up to that of the next.
struct RatioScore {
  double from = 0;
  std::size_t observations = 0;
  ErrorSpread epipolar;
  ErrorSpread corner;
};

/// Quality of the tracks of one sequence.
///
/// life: the number of frames in which a track was observed. Every track that started counts; one that is
/// still alive in the last frame counts with the frames up to there (`censored` of them), so a short sequence
/// gives short lives.
/// loss: tracks whose last observation is in a frame, over the tracks observed in it, all frames but the last
/// together. It counts the tracks that leave the image, and does not depend on the length of the sequence.
/// coverage: share of the cells of the image, kColumns x kRows, that hold a track; mean over the frames.
/// epipolar: Sampson distance of an observation and the first one of its track, under the relative pose of
/// the truth, on the normalised plane times the focal length (Hartley, Zisserman 2004, eq. 11.9). It does not
/// see errors along the epipolar line. Pairs with less than kMinBaselineM between the cameras do not count:
/// the direction between them is noise of the truth.
/// corner: distance of an observation from the pixel of the surface point that the first observation of its
/// track shows; zero at age 0. A point of something that moves moves along.
/// moving: share of the observations of tracks that began on something that moves; to an estimator they are
/// outliers.
/// A rolling shutter exposes each row at its own time: poses and points are those of the observation's row,
/// or, for the pixel that is expected, of the row in which it is expected.
struct TrackScore {
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  static constexpr double kMinBaselineM = 0.01;

  int frames = 0;
  std::size_t tracks = 0;
  std::size_t censored = 0;
  double features_per_frame = 0;
  double mean_life = 0;
  double median_life = 0;
  double loss_share = 0;
  double coverage = 0;
  double cpu_ms = 0;         ///< of the tracker a frame, median; NaN: not measured
  bool has_poses = false;    ///< epipolar is meaningful
  bool has_surface = false;  ///< corner and moving_share are meaningful
  double moving_share = 0;
  ErrorSpread epipolar;            ///< at every age above zero
  ErrorSpread corner;              ///< likewise
  std::vector<AgeScore> ages;      ///< 1, 2, 5, 10, 20, 30, 50, 100
  std::vector<RatioScore> ratios;  ///< from 0, 1.25, 1.5, 2, 3, 5, 10; at every age above zero
};

/// A point of a surface.
struct SurfacePoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< when it was seen
  int moving = -1;  ///< which of the things that move it is a point of; -1: of none
};

/// When a pixel was exposed.
struct ExposureTime {
  std::size_t frame = 0;
  double row = 0;  ///< y of the pixel
};

/// What tracks are scored against.
struct TrackTruth {
  /// Pose of the camera; empty where the truth has none. No function: no truth.
  std::function<std::optional<Pose>(const ExposureTime& time)> T_WC;
  /// What the ray from a point along a unit vector meets. No function: unknown.
  std::function<SurfacePoint(const ExposureTime& time, const Eigen::Vector3d& p_W,
                             const Eigen::Vector3d& direction_W)>
      surface;
  /// Where a point that was seen at one time is at another. No function: nothing moves.
  std::function<Eigen::Vector3d(const SurfacePoint& point, const ExposureTime& seen,
                                const ExposureTime& time)>
      moved;
};

/// frames: in order, each sorted by track id. cpu_ms: one a frame, or none.
[[nodiscard]] TrackScore ScoreTracks(const std::vector<TrackFrame>& frames, const CameraModel& camera,
                                     const TrackTruth& truth, const std::vector<double>& cpu_ms);

/// The whole score as JSON; what is unknown is null.
[[nodiscard]] std::string ScoreJson(const TrackScore& score);
/// One row an age: age,observations,epipolar_count,epipolar_median_px,epipolar_p95_px,corner_count,
/// corner_median_px,corner_p95_px.
[[nodiscard]] std::string ScoreCsv(const TrackScore& score);
/// A few lines for people.
[[nodiscard]] std::string DescribeScore(const TrackScore& score);

}  // namespace alidade
