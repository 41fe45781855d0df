#include "frontend/initialization/initializer.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/format.h"
#include "core/imu_buffer.h"
#include "core/observation_plane.h"
#include "frontend/initialization/dynamic_initializer.h"
#include "frontend/initialization/dynamic_window.h"
#include "frontend/initialization/middle_row.h"
#include "frontend/initialization/static_initializer.h"
#include "frontend/initialization/track_motion.h"

namespace alidade {
namespace {

// An attempt in motion costs a tenth of a second: not on every frame.
constexpr double kAttemptEveryS = 0.25;
// Length of the data that an attempt uses, in windows. Motion that is slow for its size determines its scale
// only over a long time; but tracks that live shortly do not reach over it. So attempts take turns.
constexpr double kUsualWindows = 3;
constexpr double kLongestWindows = 10;

/// Longest silence inside the samples; an interpolated gap would pass for rest.
double LongestStep(const std::vector<ImuSample>& samples) {
  double longest_s = 0;
  for (size_t i = 1; i < samples.size(); ++i) {
    longest_s = std::max(longest_s, SecondsBetween(samples[i - 1].stamp_ns, samples[i].stamp_ns));
  }
  return longest_s;
}

/// Where the last silence of more than `max_gap_s` ends; the first sample where there is none.
TimeNs EndOfSilence(std::span<const ImuSample> samples, double max_gap_s) {
  for (size_t i = samples.size(); i-- > 1;) {
    if (SecondsBetween(samples[i - 1].stamp_ns, samples[i].stamp_ns) > max_gap_s) {
      return samples[i].stamp_ns;
    }
  }
  return samples.empty() ? INT64_MIN : samples.front().stamp_ns;
}

}  // namespace

struct Initializer::Implementation {
  EstimatorConfig config;
  RigCalibration rig;
  ScaleDemand demand;
  ImuBuffer imu;
  std::deque<TrackFrame> frames;  // stamps are IMU time
  std::string method;
  std::string report;
  InitializerWindow window;

  Implementation(const EstimatorConfig& config_in, const RigCalibration& rig_in, const ScaleDemand& demand_in)
      : config(config_in),
        rig(OnPlane(rig_in, config_in.vision.observation_plane)),
        demand(demand_in),
        imu(config_in.imu.max_gap_s) {
    // The sheet's noise, scaled as the configuration requires: the same numbers as in the back ends.
    rig.imu_noise = config.imu.Scaled(rig.imu_noise);
  }

  TimeNs first_stamp_ns = 0;  // of the first frame: how long the search has been going on
  TimeNs next_attempt_ns = INT64_MIN;
  std::string last_refusal;  // of the last attempt in motion
  bool next_is_long = false;
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  // of that attempt [m/s^2]

  void Trim();
  std::optional<TrackMotion> MotionOverWindow() const;
  RestAssessment Assess(ImuSpread* spread);
  Result<NavEstimate> TryStatic(RestAssessment* assessment);
  [[nodiscard]] DynamicLimits Limits() const;
  Result<NavEstimate> TryDynamic();
};

/// Keeps the longest dynamic window since the IMU was silent, or as many frames as it needs when they are
/// sparse, and the IMU that reaches back to them.
void Initializer::Implementation::Trim() {
  const TimeNs newest = frames.back().stamp_ns;
  const TimeNs keep_from = newest - SecondsToNs((kLongestWindows + 0.1) * config.init.dynamic_window_s);
  const size_t keep = static_cast<size_t>(config.init.dynamic_min_frames);
  while (frames.size() > keep && frames.front().stamp_ns < keep_from) {
    frames.pop_front();
  }
  // A window that spans a silence is refused: frames before it would only hold up the start.
  const TimeNs heard_from = EndOfSilence(imu.samples(), config.imu.max_gap_s);
  while (frames.size() > 1 && frames.front().stamp_ns < heard_from) {
    frames.pop_front();
  }
  const TimeNs static_from = newest - SecondsToNs(config.init.static_window_s);
  imu.DropBefore(std::min(frames.front().stamp_ns, static_from));
}

/// Newest frame against the latest one that is a static window older, or the oldest there is; empty without
/// tracks.
std::optional<TrackMotion> Initializer::Implementation::MotionOverWindow() const {
  const TrackFrame& newest = frames.back();
  const TimeNs wanted = newest.stamp_ns - SecondsToNs(config.init.static_window_s);
  const TrackFrame* reference = &frames.front();
  for (const TrackFrame& frame : frames) {
    if (frame.stamp_ns <= wanted) {
      reference = &frame;
    }
  }
  if (reference == &newest || (newest.observations.empty() && reference->observations.empty())) {
    return std::nullopt;
  }
  return MeasureTrackMotion(*reference, newest);
}

RestAssessment Initializer::Implementation::Assess(ImuSpread* spread) {
  const TimeNs newest = frames.back().stamp_ns;
  if (imu.samples().empty()) {
    return {StaticVerdict::kTooShort, "no imu sample yet"};
  }
  const TimeNs from =
      std::max(imu.samples().front().stamp_ns, newest - SecondsToNs(config.init.static_window_s));
  std::vector<ImuSample> samples;
  if (const Status status = imu.Interval(from, newest, &samples); !status.ok()) {
    return {StaticVerdict::kTooShort, status.message()};
  }
  if (const double longest_s = LongestStep(samples); longest_s > config.imu.max_gap_s) {
    return {StaticVerdict::kTooShort,
            Format("imu is silent for %.3f s, limit %.3f", longest_s, config.imu.max_gap_s)};
  }
  *spread = MeasureImuSpread(samples);
  RestAssessment assessment = AssessRest(config.init, config.imu.gravity_mps2, *spread, MotionOverWindow());
  const bool has_tracks = !frames.back().observations.empty();
  const double seen_s = SecondsBetween(frames.front().stamp_ns, newest);
  if (assessment.verdict == StaticVerdict::kAtRest && has_tracks &&
      seen_s < 0.5 * config.init.static_window_s) {
    return {StaticVerdict::kTooShort, "at rest by the imu; tracks cover too short a time to confirm it"};
  }
  return assessment;
}

Result<NavEstimate> Initializer::Implementation::TryStatic(RestAssessment* assessment) {
  ImuSpread spread;
  *assessment = Assess(&spread);
  if (assessment->verdict != StaticVerdict::kAtRest) {
    return Status::Diverged(assessment->reason);
  }
  const NavEstimate estimate =
      StateAtRest(config.init, config.imu.gravity_mps2, rig.imu_noise, spread, frames.back().stamp_ns);
  report = Format(
      "at rest for %.2f s: gyro spread %.2g rad/s, accelerometer spread %.2g m/s^2, |f| %.4f m/s^2, gyro "
      "bias (%.4f, %.4f, %.4f) rad/s",
      spread.duration_s, spread.gyro_std_radps, spread.accel_std_mps2, spread.mean_accel.norm(),
      spread.mean_gyro.x(), spread.mean_gyro.y(), spread.mean_gyro.z());
  method = "static";
  return estimate;
}

/// The scale's limit loosens with the length of the search.
DynamicLimits Initializer::Implementation::Limits() const {
  const double windows =
      SecondsBetween(first_stamp_ns, frames.back().stamp_ns) / config.init.dynamic_window_s;
  const double share = std::clamp(
      (windows - demand.windows_of_first) / (demand.windows_to_last - demand.windows_of_first), 0.0, 1.0);
  return {demand.first * std::pow(demand.last / demand.first, share),
          config.init.dynamic_window_s * (next_is_long ? kLongestWindows : kUsualWindows)};
}

Result<NavEstimate> Initializer::Implementation::TryDynamic() {
  const TimeNs newest = frames.back().stamp_ns;
  if (newest < next_attempt_ns) {
    return Status::Diverged(last_refusal);
  }
  const Result<DynamicSolution> solution =
      InitializeDynamic(config, rig, frames, Limits(), &imu, &accel_bias);
  if (!solution.ok()) {
    next_attempt_ns = newest + SecondsToNs(kAttemptEveryS);
    last_refusal = solution.message();
    next_is_long = !next_is_long;
    return solution.status();
  }
  method = "dynamic";
  report = solution->report;
  window = solution->window;
  return solution->estimate;
}

Initializer::Initializer(const EstimatorConfig& config, const RigCalibration& rig, const ScaleDemand& demand)
    : implementation_(std::make_unique<Implementation>(config, rig, demand)) {}
Initializer::~Initializer() = default;

const std::string& Initializer::method() const {
  return implementation_->method;
}
const InitializerWindow& Initializer::window() const {
  return implementation_->window;
}
const std::string& Initializer::report() const {
  return implementation_->report;
}

void Initializer::AddImu(const ImuSample& sample) {
  // A sample that is not finite or comes too late is dropped and counted by the buffer; the next interval
  // reports a gap.
  static_cast<void>(implementation_->imu.Add(sample).ok());
}

Result<NavEstimate> Initializer::AddFrame(const TrackFrame& frame) {
  Implementation& self = *implementation_;
  const InitMethod method = self.config.init.method;
  if (method == InitMethod::kTruth) {
    return Status::Config(
        "init.method: truth takes the state from ground truth; the initializer needs static, dynamic or "
        "auto");
  }
  TrackFrame in_imu_time = frame;
  in_imu_time.stamp_ns += SecondsToNs(self.rig.camera_time_offset_s);
  if (!self.frames.empty() && in_imu_time.stamp_ns <= self.frames.back().stamp_ns) {
    return Status::Input("frame at " + FormatSeconds(frame.stamp_ns) + " s is not after the previous one");
  }
  if (self.frames.empty()) {
    self.first_stamp_ns = in_imu_time.stamp_ns;
  }
  const std::span<const ImuSample> samples = self.imu.samples();
  if (self.config.vision.rolling_shutter && !samples.empty()) {
    const auto after =
        std::upper_bound(samples.begin(), samples.end(), in_imu_time.stamp_ns,
                         [](TimeNs stamp_ns, const ImuSample& sample) { return stamp_ns < sample.stamp_ns; });
    in_imu_time =
        AtMiddleRow(self.rig, (after == samples.begin() ? after : after - 1)->gyro, std::move(in_imu_time));
  }
  self.frames.push_back(std::move(in_imu_time));
  self.Trim();
  RestAssessment assessment{StaticVerdict::kMoving, {}};
  Result<NavEstimate> estimate = Status::Diverged("not tried");
  if (method != InitMethod::kDynamic) {
    estimate = self.TryStatic(&assessment);
  }
  // A short rest is waited for: a static start is the better one.
  if (method != InitMethod::kStatic && assessment.verdict == StaticVerdict::kMoving) {
    estimate = self.TryDynamic();
  }
  return estimate;
}

}  // namespace alidade
