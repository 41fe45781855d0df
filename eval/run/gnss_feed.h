#pragma once

#include <memory>
#include <optional>

#include "core/estimator_config.h"
#include "core/measurement_log.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/single_point.h"

namespace alidade {

/// The GNSS epochs of a log one by one, prepared as the configuration says and stamped in IMU time: tag -
/// receiver clock + offset. The clock is that of the epoch's single-point solution or, where there is none,
/// the last one's, carried on by its drift.
class GnssFeed {
 public:
  /// `log.gnss` is not null.
  GnssFeed(const GnssConfig& config, const MeasurementLog& log);

  /// The next epoch, or null at the end; valid until Pop.
  const GnssEpoch* Next();
  void Pop() { next_.reset(); }
  /// Single-point solution of the epoch Next gave, if it has one.
  [[nodiscard]] const std::optional<SinglePointSolution>& solution() const { return solution_; }
  /// Antenna position that is good for directions: of the last solution, or what the log's file says.
  [[nodiscard]] const std::optional<Eigen::Vector3d>& approximate_E() const { return approximate_E_; }
  /// Added to the stamps of the epochs from now on, that at hand included.
  void ShiftTime(double offset_s);
  [[nodiscard]] double time_offset_s() const { return offset_s_; }

 private:
  [[nodiscard]] double ClockAt(TimeNs tag_ns) const;

  const GnssLog& log_;
  std::shared_ptr<const MeasurementBuilder> builder_;
  SinglePointSolver solver_;
  double offset_s_;
  size_t index_ = 0;
  std::optional<GnssEpoch> next_;
  std::optional<SinglePointSolution> solution_;
  std::optional<SinglePointSolution> last_;
  std::optional<Eigen::Vector3d> approximate_E_;
};

}  // namespace alidade
