#include "eval/run/gnss_feed.h"

#include "gnss/base/constants.h"

namespace alidade {

GnssFeed::GnssFeed(const GnssConfig& config, const MeasurementLog& log)
    : log_(*log.gnss),
      builder_(std::make_shared<const MeasurementBuilder>(log.gnss->catalog, config.corrections,
                                                          log.gnss->glonass_channels)),
      solver_(*builder_, SinglePointOptions(), log.gnss->approximate_position_E),
      offset_s_(log.rig.gnss.time_offset_s),
      approximate_E_(log.gnss->approximate_position_E) {}

double GnssFeed::ClockAt(TimeNs tag_ns) const {
  if (solution_) {
    return solution_->clock_m;
  }
  return last_ ? last_->clock_m + last_->drift_mps * SecondsBetween(last_->tag_ns, tag_ns) : 0;
}

void GnssFeed::ShiftTime(double offset_s) {
  offset_s_ += offset_s;
  if (next_) {
    next_->stamp_ns += SecondsToNs(offset_s);
  }
}

const GnssEpoch* GnssFeed::Next() {
  if (next_) {
    return &*next_;
  }
  if (index_ == log_.epochs.size()) {
    return nullptr;
  }
  const ObservationEpoch& raw = log_.epochs[index_++];
  GnssEpoch epoch;
  epoch.measurements = builder_->Prepare(raw);
  Result<SinglePointSolution> solution = solver_.Solve(epoch.measurements);
  solution_.reset();
  if (solution.ok()) {
    solution_ = *std::move(solution);
    last_ = solution_;
    approximate_E_ = solution_->position_E;
  }
  epoch.stamp_ns = raw.stamp_ns - SecondsToNs(ClockAt(raw.stamp_ns) / kSpeedOfLight) + SecondsToNs(offset_s_);
  epoch.builder = builder_;
  next_ = std::move(epoch);
  return &*next_;
}

}  // namespace alidade
