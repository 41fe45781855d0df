#include "eval/dataset/gnss_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gnss/base/geodesy.h"
#include "gnss/positioning/single_point.h"

namespace alidade {
namespace {

/// Course of an epoch [rad], counterclockwise from east.
std::optional<double> CourseOf(const Result<SinglePointSolution>& solution) {
  constexpr double kLeastSpeedMps = 1;
  constexpr double kMostDeviation = 0.1;
  if (!solution.ok() || !solution->has_velocity) {
    return std::nullopt;
  }
  const Eigen::Matrix3d R_NE = EnuFrame::At(solution->position_E).R_EN.transpose();
  const Eigen::Vector3d velocity = R_NE * solution->velocity_E;
  const double speed = velocity.head<2>().norm();
  const double variance =
      (R_NE * solution->velocity_covariance_E * R_NE.transpose()).topLeftCorner<2, 2>().trace();
  if (!(speed >= kLeastSpeedMps) || !(std::sqrt(variance) <= kMostDeviation * speed)) {
    return std::nullopt;
  }
  return std::atan2(velocity.y(), velocity.x());
}

/// The direction of up in the body and the turn about it.
class Vertical {
 public:
  void Add(const ImuSample& sample) {
    constexpr double kSettleS = 5;  // longer than a stride or a bend, shorter than a gyroscope's bias matters
    constexpr double kGapS = 0.5;
    const double step_s = SecondsBetween(last_ns_, sample.stamp_ns);
    last_ns_ = sample.stamp_ns;
    if (up_.isZero() || step_s > kGapS) {
      up_ = sample.accel;
      return;
    }
    turn_ += sample.gyro.dot(up_.stableNormalized()) * step_s;
    up_ -= step_s * sample.gyro.cross(up_);
    up_ += step_s / kSettleS * (sample.accel - up_);
  }
  [[nodiscard]] double turn_rad() const { return turn_; }

 private:
  TimeNs last_ns_ = 0;
  Eigen::Vector3d up_ = Eigen::Vector3d::Zero();  ///< specific force, low-pass
  double turn_ = 0;
};

}  // namespace

std::vector<CourseChange> CourseChanges(const GnssLog& log) {
  constexpr std::size_t kPairs = 150;
  constexpr double kLeastS = 0.8, kMostS = 2.5;
  const MeasurementBuilder builder(log.catalog, GnssCorrectionOptions(), log.glonass_channels);
  std::vector<CourseChange> changes;
  const std::size_t step = std::max<std::size_t>(1, log.epochs.size() / kPairs);
  for (std::size_t i = 0; i < log.epochs.size(); i += step) {
    const TimeNs first_ns = log.epochs[i].stamp_ns;
    if (!changes.empty() && first_ns < changes.back().last_ns) {
      continue;
    }
    std::size_t k = i;
    while (k < log.epochs.size() && SecondsBetween(first_ns, log.epochs[k].stamp_ns) < kLeastS) {
      ++k;
    }
    if (k == log.epochs.size() || SecondsBetween(first_ns, log.epochs[k].stamp_ns) > kMostS) {
      continue;
    }
    // Anew for each pair, which may be far from the one before.
    SinglePointSolver solver(builder, SinglePointOptions(), log.approximate_position_E);
    const std::optional<double> before = CourseOf(solver.Solve(log.epochs[i]));
    const std::optional<double> after = before ? CourseOf(solver.Solve(log.epochs[k])) : std::nullopt;
    if (after) {
      changes.push_back(
          {first_ns, log.epochs[k].stamp_ns, std::remainder(*after - *before, 2 * std::numbers::pi)});
    }
  }
  return changes;
}

Result<VerticalTurns> VerticalTurns::Of(const Table<ImuSample>& imu) {
  constexpr double kStepS = 0.1;
  VerticalTurns turns;
  Vertical vertical;
  ALIDADE_RETURN_IF_ERROR(imu.ForEach([&](const ImuSample& sample) {
    vertical.Add(sample);
    if (turns.stamps_.empty() || SecondsBetween(turns.stamps_.back(), sample.stamp_ns) >= kStepS) {
      turns.stamps_.push_back(sample.stamp_ns);
      turns.turns_.push_back(vertical.turn_rad());
    }
  }));
  return turns;
}

std::optional<double> VerticalTurns::At(TimeNs stamp_ns) const {
  constexpr double kGapS = 0.5;
  const auto after = std::upper_bound(stamps_.begin(), stamps_.end(), stamp_ns);
  if (after == stamps_.begin() || after == stamps_.end()) {
    return std::nullopt;
  }
  const auto k = static_cast<std::size_t>(after - stamps_.begin());
  const double step_s = SecondsBetween(stamps_[k - 1], stamps_[k]);
  if (step_s > kGapS) {
    return std::nullopt;
  }
  const double share = SecondsBetween(stamps_[k - 1], stamp_ns) / step_s;
  return turns_[k - 1] + share * (turns_[k] - turns_[k - 1]);
}

std::optional<double> VerticalTurns::Between(TimeNs first_ns, TimeNs last_ns) const {
  const std::optional<double> first = At(first_ns), last = At(last_ns);
  return first && last ? std::optional(*last - *first) : std::nullopt;
}

CourseAgreement VerticalTurns::Compare(const std::vector<CourseChange>& courses, TimeNs shift_ns) const {
  double pairs = 0, course = 0, body = 0, course2 = 0, body2 = 0, product = 0;
  for (const CourseChange& change : courses) {
    if (const std::optional<double> turn = Between(change.first_ns + shift_ns, change.last_ns + shift_ns)) {
      pairs += 1;
      course += change.turn_rad;
      body += *turn;
      course2 += change.turn_rad * change.turn_rad;
      body2 += *turn * *turn;
      product += change.turn_rad * *turn;
    }
  }
  CourseAgreement agreement;
  agreement.pairs = static_cast<int>(pairs);
  const double of_course = pairs * course2 - course * course;
  const double of_body = pairs * body2 - body * body;
  if (of_course > 0 && of_body > 0) {
    const double common = pairs * product - course * body;
    agreement.correlation = common / std::sqrt(of_course * of_body);
    agreement.slope = common / of_course;
  }
  return agreement;
}

std::optional<CourseShift> ShiftByCourse(const std::vector<CourseChange>& courses, const VerticalTurns& turns,
                                         TimeNs offset_ns) {
  constexpr int kLeastPairs = 30;
  constexpr double kUnlike = 0.3;
  // By chance 30 pairs have a correlation of 0.7 once in 100 000 times. Clocks that agree to half a second
  // leave a person who walks 0.78, and a slope of 0.69.
  constexpr double kAlike = 0.7;
  constexpr double kSlopeError = 0.5;
  const CourseAgreement as_given = turns.Compare(courses, offset_ns);
  if (as_given.pairs < kLeastPairs || as_given.correlation >= kUnlike) {
    return std::nullopt;
  }
  std::optional<CourseShift> best;
  for (const ClockShift& shift : KnownClockShifts(courses.front().first_ns)) {
    const CourseAgreement shifted = turns.Compare(courses, offset_ns + shift.shift_ns);
    if (shifted.pairs >= kLeastPairs && shifted.correlation > (best ? best->shifted.correlation : kAlike) &&
        std::abs(shifted.slope - 1) < kSlopeError) {
      best = CourseShift{shift, as_given, shifted};
    }
  }
  return best;
}

}  // namespace alidade
