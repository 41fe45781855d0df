#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/rig_calibration.h"
#include "eval/run/fix_feed.h"
#include "eval/run/sensor_run.h"
#include "gnss/alignment/fix_aligner.h"

namespace alidade {

/// What a session does with its position fixes: before the alignment they go to the aligner, after it to the
/// estimator. Where raw GNSS is in use it aligns the run, and fixes before that are not used.
class FixRun final : public MeasurementRun {
 public:
  /// All must outlive the object. `with_gnss`: raw GNSS is in use too.
  FixRun(const EstimatorConfig& config, const RigCalibration& rig, double lateness_s, bool with_gnss,
         Estimator* estimator, std::vector<SessionEvent>* events);

  [[nodiscard]] std::optional<TimeNs> NextImuTime() override;
  [[nodiscard]] std::size_t waiting() const override { return feed_.size(); }
  void SkipNext() override;
  [[nodiscard]] bool aligned() const override { return aligned_; }
  Result<bool> Take(bool running) override;
  bool Add(const Measurement& measurement, TimeNs processed_ns) override;
  /// Hands the aligner the state too. Nothing to do where raw GNSS aligns.
  Result<std::optional<GnssAlignment>> Align(TimeNs stamp_ns) override;
  void AlignedByAnother(const std::optional<EnuFrame>& enu) override;
  Status Realign() override;

 private:
  [[nodiscard]] std::optional<AbsoluteComparison> Compare(const PositionFix& fix) const;

  Estimator& estimator_;
  const std::vector<FixSensor>& sensors_;
  FixFeed feed_;
  FixAligner aligner_;
  const bool with_gnss_;
  bool aligned_ = false;
  std::optional<GnssAlignment> alignment_;  ///< from fixes
  std::string waiting_for_;                 ///< as last reported
};

}  // namespace alidade
