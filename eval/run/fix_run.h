#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/rig_calibration.h"
#include "eval/run/fix_feed.h"
#include "eval/run/session_event.h"
#include "gnss/alignment/fix_aligner.h"

namespace alidade {

/// What a session does with its position fixes: before the alignment they go to the aligner, after it to the
/// estimator. Where raw GNSS is in use it aligns the run, and fixes before that are not used. Statuses it
/// returns mean that the estimator is lost (kDiverged) or takes no fixes (kConfig).
class FixRun {
 public:
  /// All must outlive the object. `with_gnss`: raw GNSS is in use too.
  FixRun(const EstimatorConfig& config, const RigCalibration& rig, bool with_gnss, Estimator* estimator,
         std::vector<SessionEvent>* events);

  [[nodiscard]] FixFeed& feed() { return feed_; }
  [[nodiscard]] bool aligned() const { return aligned_; }

  /// The next fix of feed(); `running`: there is an estimate. The IMU reaches the fix when the run is
  /// aligned. True when the estimator took it.
  Result<bool> TakeFix(bool running);
  /// A frame was taken at `stamp_ns`. Hands the aligner the state there, and the estimator the alignment as
  /// soon as there is one, which is then returned. Nothing to do where raw GNSS aligns.
  Result<std::optional<GnssAlignment>> Align(TimeNs stamp_ns);
  /// Raw GNSS has aligned the run.
  void AlignedByGnss(const EnuFrame& enu);
  /// The estimator has begun anew with a state that stands in the frame of the fixes already. Nothing to do
  /// where raw GNSS aligns.
  Status Realign();

 private:
  Estimator& estimator_;
  std::vector<SessionEvent>& events_;
  FixFeed feed_;
  FixAligner aligner_;
  const bool with_gnss_;
  bool aligned_ = false;
  std::optional<GnssAlignment> alignment_;  ///< from fixes
  std::string waiting_for_;                 ///< as last reported
};

}  // namespace alidade
