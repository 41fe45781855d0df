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
/// track shows; zero at age 0.
/// Neglected: the line delay of a rolling shutter.
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
  double cpu_ms = 0;           ///< of the tracker a frame, median; NaN: not measured
  bool has_poses = false;      ///< epipolar is meaningful
  bool has_surface = false;    ///< corner is meaningful
  ErrorSpread epipolar;        ///< at every age above zero
  ErrorSpread corner;          ///< likewise
  std::vector<AgeScore> ages;  ///< 1, 2, 5, 10, 20, 30, 50, 100
};

/// What tracks are judged against.
struct TrackTruth {
  /// Pose of the camera in each frame, empty where the truth does not tell; no poses: no truth.
  std::vector<std::optional<Pose>> T_WC;
  /// Distance [m] from a point along a unit vector to the first surface; empty: unknown.
  std::function<double(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W)> distance;
};

/// frames: in order, each sorted by track id. cpu_ms: one a frame, or none. T_WC: one a frame, or none.
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
