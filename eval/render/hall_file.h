#pragma once

#include <string>

#include "eval/render/render_hall.h"

namespace alidade {

// What was drawn in a rendered sequence, beside its images in mav0/cam0: hall.csv, the shape of the hall, and
// data_pose.csv, the pose T_WC of the camera in the middle of each exposure in the columns of a truth file;
// with a rolling shutter, poses before and after it too, so that those of all rows lie close between two. A
// truth in state_groundtruth_estimate0 that was recorded is followed by the renderer through a spline, so the
// poses differ from it.
[[nodiscard]] std::string HallPath(const std::string& sequence);
[[nodiscard]] std::string CameraPosesPath(const std::string& sequence);

/// Writes the shape of a hall, without its textures: one row an object,
/// `#shape,x_0 [m],y_0 [m],z_0 [m],x_1 [m],y_1 [m],z_1 [m]`. `origin`: the point in W that the other rows
/// count from, then zeros; `room` and `box`: lower and upper corner; `column`: axis in x_0 and y_0, its
/// radius in x_1, else zeros; `moving`: a moving box in the middle of its line, followed by `travel`: the
/// vector, then its period [s] and phase [rad]; `epoch`, where something moves: the stamp of hall time 0,
/// whole seconds and the nanoseconds that remain. kOutput: cannot be written.
Status WriteHall(const Hall& hall, const std::string& path);

/// Reads it; surfaces have no texture. Errors (kInput): file and line of a torn row, a shape of another name,
/// corners in the wrong order, a moving box without travel; no origin or no room.
Result<Hall> ReadHall(const std::string& path);

}  // namespace alidade
