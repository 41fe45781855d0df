#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>

#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/pseudorange_errors.h"
#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_solution.h"

namespace alidade {

/// What is known of the satellites before the first epoch.
struct GnssSetup {
  /// Null: no ephemerides yet (GnssFeed::AddCatalog).
  std::shared_ptr<const SatelliteCatalog> catalog;
  std::map<int, int> glonass_channels;
  std::optional<Eigen::Vector3d> approximate_position_E;  ///< of the antenna; not trusted
};
[[nodiscard]] GnssSetup SetupOf(const GnssLog& log);

/// GNSS epochs one by one in the order of their tags, prepared as configured and stamped in IMU
/// time: tag - receiver clock + offset. The clock is that of the epoch's single-point solution or, where
/// there is none, the last one's, carried on by its drift.
class GnssFeed {
 public:
  /// `time_offset_s`: GnssReceiver::time_offset_s.
  GnssFeed(const GnssConfig& config, const GnssSetup& setup, double time_offset_s);

  enum class Arrival { kTaken, kTwice, kTooLate };
  /// Sorts the epoch in. kTooLate: its tag is not after that of the last popped one. The result of Next does
  /// not depend on the order of arrival.
  Arrival Add(std::shared_ptr<const ObservationEpoch> epoch);
  /// Epochs with tags from `from_tag_ns` on use this catalog.
  void AddCatalog(TimeNs from_tag_ns, std::shared_ptr<const SatelliteCatalog> catalog);

  /// The epoch with the smallest tag, or null when none waits; valid until the next call of another member.
  const GnssEpoch* Next();
  /// After Next. Lets its epoch go.
  void Pop();
  /// Single-point solution of the epoch Next gave, if it has one.
  [[nodiscard]] const std::optional<SinglePointSolution>& solution() const { return solution_; }
  /// Antenna position that is good for directions: of the last solution, or as set up.
  [[nodiscard]] const std::optional<Eigen::Vector3d>& approximate_E() const;
  /// Added to the stamps of the epochs from now on, that at hand included.
  void ShiftTime(double offset_s);
  [[nodiscard]] double time_offset_s() const { return offset_s_; }

  [[nodiscard]] size_t size() const { return waiting_.size(); }
  [[nodiscard]] TimeNs last_tag_ns() const { return last_tag_ns_; }
  /// IMU time of an epoch of this tag by the clock of the last popped epoch; nothing while none is
  /// known.
  [[nodiscard]] std::optional<TimeNs> ExpectedStamp(TimeNs tag_ns) const;

 private:
  /// What one epoch leaves to the next.
  struct State {
    std::shared_ptr<const MeasurementBuilder> builder;
    SinglePointSolver solver;
    std::optional<SinglePointSolution> last;
    std::optional<Eigen::Vector3d> approximate_E;

    [[nodiscard]] double ClockAt(TimeNs tag_ns) const;
  };
  /// Of the epochs with this tag on.
  void UseCatalog(TimeNs tag_ns, State* state) const;

  GnssCorrectionOptions corrections_;
  bool lasting_errors_;
  PseudorangeErrors errors_;  ///< of the epochs that were popped
  std::map<int, int> glonass_channels_;
  double offset_s_;
  std::map<TimeNs, std::shared_ptr<const SatelliteCatalog>> catalogs_;  ///< not in use yet, by first tag
  std::deque<std::shared_ptr<const ObservationEpoch>> waiting_;         ///< rising tags
  TimeNs last_tag_ns_ = INT64_MIN;                                      ///< popped
  State state_;                                                         ///< after the last popped epoch
  std::optional<State> after_;  ///< after the epoch at hand; it may still find one before it
  std::optional<GnssEpoch> next_;
  std::optional<SinglePointSolution> solution_;
};

}  // namespace alidade
