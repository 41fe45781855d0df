#include "eval/cli/score.h"

#include <cstdio>

#include "eval/cli/flags.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/frontend_run/track_score.h"
#include "eval/render/hall_file.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade::cli {
namespace {

/// Poses of the camera at the stamps of the frames, from a trajectory of `T_BC`'s body in a clock that is
/// `offset_ns` ahead of the camera's; empty where the trajectory does not reach.
std::vector<std::optional<Pose>> PosesAt(const std::vector<TrackFrame>& tracks, const Trajectory& trajectory,
                                         TimeNs offset_ns, const Pose& T_BC) {
  std::vector<std::optional<Pose>> T_WC;
  for (const TrackFrame& frame : tracks) {
    const Result<TrajectoryPoint> point = InterpolateTruth(trajectory, frame.stamp_ns + offset_ns);
    T_WC.push_back(point.ok() ? std::optional(point->nav.T_WB() * T_BC) : std::nullopt);
  }
  return T_WC;
}

/// What was drawn, of a rendered sequence; else the truth, if it has orientations.
Result<TrackTruth> TruthOf(const Dataset& dataset, const std::vector<TrackFrame>& tracks) {
  TrackTruth truth;
  if (!MayExist(HallPath(dataset.path))) {
    if (dataset.truth.has_value() && dataset.truth->has_orientation) {
      truth.T_WC =
          PosesAt(tracks, *dataset.truth, SecondsToNs(dataset.rig.camera_time_offset_s), dataset.rig.T_BC);
    }
    return truth;
  }
  Result<Hall> hall = ReadHall(HallPath(dataset.path));
  ALIDADE_RETURN_IF_ERROR(hall.status());
  const Result<Trajectory> poses = ReadTrajectory(CameraPosesPath(dataset.path));
  ALIDADE_RETURN_IF_ERROR(poses.status());
  truth.T_WC = PosesAt(tracks, *poses, 0, Pose());
  truth.distance = [shape = *std::move(hall)](const Eigen::Vector3d& p_W,
                                              const Eigen::Vector3d& direction_W) {
    return shape.Distance(p_W, direction_W);
  };
  return truth;
}

}  // namespace

Status JudgeTracks(const Dataset& dataset, const std::vector<TrackFrame>& tracks,
                   const std::vector<double>& cpu_ms) {
  const Result<TrackTruth> truth = TruthOf(dataset, tracks);
  ALIDADE_RETURN_IF_ERROR(truth.status());
  const TrackScore score = ScoreTracks(tracks, dataset.rig.camera, *truth, cpu_ms);
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(FLAGS_output + "/score.json", ScoreJson(score)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(FLAGS_output + "/score.csv", ScoreCsv(score)));
  std::printf("%s", DescribeScore(score).c_str());
  return Status::Ok();
}

}  // namespace alidade::cli
