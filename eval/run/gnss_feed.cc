#include "eval/run/gnss_feed.h"

#include <algorithm>
#include <utility>

#include "gnss/base/constants.h"

namespace alidade {
namespace {

std::shared_ptr<const MeasurementBuilder> MakeBuilder(std::shared_ptr<const SatelliteCatalog> catalog,
                                                      const GnssCorrectionOptions& corrections,
                                                      const std::map<int, int>& glonass_channels) {
  if (catalog == nullptr) {
    catalog = std::make_shared<const SatelliteCatalog>(NavigationData());
  }
  return std::make_shared<const MeasurementBuilder>(std::move(catalog), corrections, glonass_channels);
}

}  // namespace

GnssSetup SetupOf(const GnssLog& log) {
  return {log.catalog, log.glonass_channels, log.approximate_position_E};
}

GnssFeed::GnssFeed(const GnssConfig& config, const GnssSetup& setup, double time_offset_s)
    : corrections_(config.corrections),
      lasting_errors_(config.lasting_errors),
      glonass_channels_(setup.glonass_channels),
      offset_s_(time_offset_s),
      state_([&]() -> State {
        auto builder = MakeBuilder(setup.catalog, config.corrections, setup.glonass_channels);
        SinglePointSolver solver(*builder, SinglePointOptions(), setup.approximate_position_E);
        return {std::move(builder), std::move(solver), std::nullopt, setup.approximate_position_E};
      }()) {}

double GnssFeed::State::ClockAt(TimeNs tag_ns) const {
  return last ? last->clock_m + last->drift_mps * SecondsBetween(last->tag_ns, tag_ns) : 0;
}

GnssFeed::Arrival GnssFeed::Add(std::shared_ptr<const ObservationEpoch> epoch) {
  if (epoch->stamp_ns <= last_tag_ns_) {
    return Arrival::kTooLate;
  }
  const auto place = std::lower_bound(
      waiting_.begin(), waiting_.end(), epoch->stamp_ns,
      [](const std::shared_ptr<const ObservationEpoch>& other, TimeNs tag) { return other->stamp_ns < tag; });
  if (place != waiting_.end() && (*place)->stamp_ns == epoch->stamp_ns) {
    return Arrival::kTwice;
  }
  if (place == waiting_.begin()) {
    next_.reset();
  }
  waiting_.insert(place, std::move(epoch));
  return Arrival::kTaken;
}

void GnssFeed::AddCatalog(TimeNs from_tag_ns, std::shared_ptr<const SatelliteCatalog> catalog) {
  catalogs_[from_tag_ns] = std::move(catalog);
  next_.reset();
}

void GnssFeed::UseCatalog(TimeNs tag_ns, State* state) const {
  auto newest = catalogs_.upper_bound(tag_ns);
  if (newest == catalogs_.begin()) {
    return;
  }
  --newest;
  state->builder = MakeBuilder(newest->second, corrections_, glonass_channels_);
  state->solver.SetBuilder(*state->builder);
}

const std::optional<Eigen::Vector3d>& GnssFeed::approximate_E() const {
  return next_ ? after_->approximate_E : state_.approximate_E;
}

std::optional<TimeNs> GnssFeed::ExpectedStamp(TimeNs tag_ns) const {
  if (!state_.last) {
    return std::nullopt;
  }
  return tag_ns - SecondsToNs(state_.ClockAt(tag_ns) / kSpeedOfLight) + SecondsToNs(offset_s_);
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
  if (waiting_.empty()) {
    return nullptr;
  }
  const ObservationEpoch& raw = *waiting_.front();
  after_ = state_;
  UseCatalog(raw.stamp_ns, &*after_);
  GnssEpoch epoch;
  epoch.measurements = after_->builder->Prepare(raw);
  Result<SinglePointSolution> solution = after_->solver.Solve(epoch.measurements);
  solution_.reset();
  if (solution.ok()) {
    solution_ = *std::move(solution);
    after_->last = solution_;
    after_->approximate_E = solution_->position_E;
  }
  const double clock_m = solution_ ? solution_->clock_m : after_->ClockAt(raw.stamp_ns);
  epoch.stamp_ns = raw.stamp_ns - SecondsToNs(clock_m / kSpeedOfLight) + SecondsToNs(offset_s_);
  epoch.builder = after_->builder;
  if (lasting_errors_) {
    epoch.measurements.noise = errors_.noise();
    for (std::size_t k = 0; solution_ && k < epoch.measurements.satellites.size(); ++k) {
      epoch.measurements.satellites[k].contradicted = !solution_->satellites[k].used;
    }
  }
  next_ = std::move(epoch);
  return &*next_;
}

void GnssFeed::Pop() {
  if (solution_ && lasting_errors_) {
    errors_.Add(*solution_);
  }
  last_tag_ns_ = waiting_.front()->stamp_ns;
  waiting_.pop_front();
  state_ = *std::move(after_);
  after_.reset();
  next_.reset();
  catalogs_.erase(catalogs_.begin(), catalogs_.upper_bound(last_tag_ns_));
}

}  // namespace alidade
