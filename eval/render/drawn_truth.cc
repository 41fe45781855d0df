#include "eval/render/drawn_truth.h"

#include <functional>
#include <optional>
#include <utility>

#include "eval/files/input_file.h"
#include "eval/render/hall_file.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade {
namespace {

/// When a pixel was exposed, in the camera's clock, by the line delay of the sheet.
class Shutter {
 public:
  Shutter(const RigCalibration& rig, const std::vector<TrackFrame>& tracks)
      : line_delay_s_(rig.line_delay_s), middle_row_(0.5 * rig.camera.height_px()) {
    for (const TrackFrame& frame : tracks) {
      stamps_.push_back(frame.stamp_ns);
    }
  }

  [[nodiscard]] TimeNs StampOf(const ExposureTime& time) const {
    const TimeNs stamp_ns = stamps_[time.frame];
    return line_delay_s_ == 0 ? stamp_ns : stamp_ns + SecondsToNs(line_delay_s_ * (time.row - middle_row_));
  }

 private:
  double line_delay_s_;
  double middle_row_;
  std::vector<TimeNs> stamps_;
};

/// Poses of the camera from a trajectory of `T_BC`'s body in a clock that is `offset_ns` ahead of the
/// camera's; empty where the trajectory does not reach.
std::function<std::optional<Pose>(const ExposureTime&)> PosesFrom(Trajectory trajectory, Shutter shutter,
                                                                  TimeNs offset_ns, const Pose& T_BC) {
  return [trajectory = std::move(trajectory), shutter = std::move(shutter), offset_ns,
          T_BC](const ExposureTime& time) -> std::optional<Pose> {
    const Result<TrajectoryPoint> point = InterpolateTruth(trajectory, shutter.StampOf(time) + offset_ns);
    return point.ok() ? std::optional(point->nav.T_WB() * T_BC) : std::nullopt;
  };
}

/// Points of what was drawn.
void AddSurfaces(const Hall& shape, const Shutter& shutter, TrackTruth* truth) {
  const auto time_of = [epoch_ns = shape.epoch_ns, shutter](const ExposureTime& time) {
    return SecondsBetween(epoch_ns, shutter.StampOf(time));
  };
  truth->surface = [shape, time_of](const ExposureTime& time, const Eigen::Vector3d& p_W,
                                    const Eigen::Vector3d& direction_W) {
    const HallRay ray = shape.Trace(p_W, direction_W, time_of(time));
    return SurfacePoint{p_W + ray.distance * direction_W, ray.moving};
  };
  if (!shape.moving.empty()) {
    truth->moved = [shape, time_of](const SurfacePoint& point, const ExposureTime& seen,
                                    const ExposureTime& time) -> Eigen::Vector3d {
      if (point.moving < 0) {
        return point.p_W;
      }
      const MovingBox& box = shape.moving[static_cast<std::size_t>(point.moving)];
      return point.p_W + box.Shift(time_of(time)) - box.Shift(time_of(seen));
    };
  }
}

}  // namespace

Result<TrackTruth> TruthOfTracks(const Dataset& dataset, const std::vector<TrackFrame>& tracks) {
  TrackTruth truth;
  const Shutter shutter(dataset.rig, tracks);
  if (!MayExist(HallPath(dataset.path))) {
    if (dataset.truth.has_value() && dataset.truth->has_orientation) {
      truth.T_WC =
          PosesFrom(*dataset.truth, shutter, SecondsToNs(dataset.rig.camera_time_offset_s), dataset.rig.T_BC);
    }
    return truth;
  }
  const Result<Hall> hall = ReadHall(HallPath(dataset.path));
  ALIDADE_RETURN_IF_ERROR(hall.status());
  Result<Trajectory> poses = ReadTrajectory(CameraPosesPath(dataset.path));
  ALIDADE_RETURN_IF_ERROR(poses.status());
  truth.T_WC = PosesFrom(*std::move(poses), shutter, 0, Pose());
  AddSurfaces(*hall, shutter, &truth);
  return truth;
}

}  // namespace alidade
