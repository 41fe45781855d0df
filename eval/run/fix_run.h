#pragma once

#include <optional>
#include <string>

#include "core/estimator.h"
#include "core/measurement_log.h"
#include "eval/run/fix_feed.h"
#include "gnss/alignment/fix_aligner.h"

namespace alidade {

/// What a run does with its position fixes: before the alignment they go to the aligner, after it to the
/// estimator. Statuses it returns mean that the estimator is lost (kDiverged) or takes no fixes (kConfig).
class FixRun {
 public:
  /// `rig` and `estimator` must outlive it. `with_gnss`: raw GNSS is in use too, and aligns the run.
  FixRun(const EstimatorConfig& config, const RigCalibration& rig, bool with_gnss, Estimator* estimator);

  [[nodiscard]] FixFeed& feed() { return feed_; }
  [[nodiscard]] bool aligned() const { return aligned_; }
  /// What the alignment found, or is missing.
  [[nodiscard]] const std::string& report() const { return aligner_.report(); }

  enum class Outcome {
    kAligning,  ///< handed to the aligner
    kTaken,     ///< by the estimator, inside its gate or not
    kRefused,   ///< by the estimator: older than its state, or beyond the IMU
  };
  /// The next fix of feed(). The IMU reaches it when the run is aligned; there is an estimate.
  Result<Outcome> Take();
  /// A frame was taken: hands the aligner the state there, and the estimator the alignment as soon as there
  /// is one, which is then returned.
  Result<std::optional<GnssAlignment>> Align(const NavEstimate& estimate);
  /// Raw GNSS has aligned the run, or did so before the estimator began anew.
  void AlignedByGnss(const EnuFrame& enu);
  /// The estimator has begun anew with a state that stands in the frame of the fixes already. Nothing to do
  /// where raw GNSS aligns.
  Status Realign();

 private:
  Estimator& estimator_;
  FixFeed feed_;
  FixAligner aligner_;
  bool with_gnss_;
  bool aligned_ = false;
  std::optional<GnssAlignment> alignment_;
};

}  // namespace alidade
