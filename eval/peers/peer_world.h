#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/navigation_state.h"
#include "core/status.h"
#include "eval/trajectory/trajectory.h"
#include "gnss/base/geodesy.h"

namespace alidade {

/// Brings the rows of a system with GNSS from its own gravity-aligned world W into ENU N at the sequence's
/// anchor. Rows before the alignment are brought there with it, as those of our estimators are.
class PeerWorld {
 public:
  /// Without an anchor rows stay as they are.
  explicit PeerWorld(const std::optional<Eigen::Vector3d>& anchor_E);

  /// `T_EW`: from W to ECEF, as the system estimates it at this row; empty before its alignment.
  void Add(const TrajectoryPoint& point, const std::optional<Pose>& T_EW);
  /// The system starts anew in another world: what follows is brought into N by the next alignment.
  void Restart() { begin_ = points_.size(); }

  [[nodiscard]] const std::vector<TrajectoryPoint>& points() const { return points_; }
  /// Stamp of the first row after the first alignment.
  [[nodiscard]] std::optional<TimeNs> aligned_ns() const { return aligned_ns_; }

 private:
  std::optional<EnuFrame> enu_;
  std::size_t begin_ = 0;  ///< of the rows of the present world that are not aligned yet
  std::optional<TimeNs> aligned_ns_;
  std::vector<TrajectoryPoint> points_;
};

}  // namespace alidade
