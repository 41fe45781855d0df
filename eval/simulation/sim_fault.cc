#include "eval/simulation/sim_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "eval/simulation/sim_imu_fault.h"

namespace alidade {
namespace {

constexpr std::array<SimOutlierKind, 5> kKinds = {SimOutlierKind::kJump, SimOutlierKind::kUniform,
                                                  SimOutlierKind::kSwap, SimOutlierKind::kDrift,
                                                  SimOutlierKind::kMoving};
constexpr std::uint64_t kOnsets = 4;                 // 1 to this many frames after the first
constexpr std::int64_t kSecondLife = 1'000'000'000;  // added to the id of a track that comes back

void BlackOut(const std::function<bool(TimeNs)>& fails, std::vector<TrackFrame>* frames) {
  std::set<std::int64_t> before;
  bool over = false;
  for (TrackFrame& frame : *frames) {
    if (fails(frame.stamp_ns)) {
      frame.observations.clear();
      over = true;
    }
    for (TrackObservation& observation : frame.observations) {
      if (!over) {
        before.insert(observation.track_id);
      } else if (before.count(observation.track_id) > 0) {
        observation.track_id += kSecondLife;
      }
    }
    std::sort(frame.observations.begin(), frame.observations.end(),
              [](const TrackObservation& a, const TrackObservation& b) { return a.track_id < b.track_id; });
  }
}

void ShuffleIds(const std::function<bool(TimeNs)>& fails, std::uint64_t seed, const std::string& camera,
                std::vector<TrackFrame>* frames) {
  RandomStream random(seed, "fault/tracks" + camera);
  for (TrackFrame& frame : *frames) {
    if (!fails(frame.stamp_ns)) {
      continue;
    }
    std::vector<Eigen::Vector2d> pixels;
    for (const TrackObservation& observation : frame.observations) {
      pixels.push_back(observation.pixel);
    }
    random.Shuffle(&pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      frame.observations[i].pixel = pixels[i];
    }
  }
}

void Freeze(const std::function<bool(TimeNs)>& fails, std::vector<TrackFrame>* frames) {
  const TrackFrame* first = nullptr;
  for (TrackFrame& frame : *frames) {
    if (!fails(frame.stamp_ns)) {
      continue;
    }
    if (first == nullptr) {
      first = &frame;
    }
    frame.observations = std::vector<TrackObservation>(first->observations);
  }
}

/// Of the frames or images at these stamps, in their order.
template <typename Item, typename StampOf>
void Drop(const std::function<bool(TimeNs)>& fails, double rate, std::uint64_t seed,
          const std::string& camera, const StampOf& stamp_of, std::vector<Item>* items) {
  RandomStream random(seed, "fault/frame_drops" + camera);
  std::erase_if(*items, [&](const Item& item) { return fails(stamp_of(item)) && random.Chance(rate); });
}

/// Of the tracks of one camera; `camera` names its stream, empty for the first one.
void ApplyToTracks(const SimulatorConfig& config, std::uint64_t seed, const std::string& camera,
                   const std::function<bool(TimeNs)>& fails, std::vector<TrackFrame>* frames) {
  switch (config.fault) {
    case SimFaultKind::kBlackout:
    case SimFaultKind::kBlackoutAndImu:
      BlackOut(fails, frames);
      break;
    case SimFaultKind::kTracks:
      ShuffleIds(fails, seed, camera, frames);
      break;
    case SimFaultKind::kFrozen:
      Freeze(fails, frames);
      break;
    case SimFaultKind::kFrameDrops:
      Drop(
          fails, config.fault_drop_rate, seed, camera, [](const TrackFrame& frame) { return frame.stamp_ns; },
          frames);
      break;
    default:
      break;
  }
}

}  // namespace

RandomStream FaultSource::Stream(const char* purpose, int landmark, int frame) const {
  return {seed_, camera_ + "." + purpose + "/" + std::to_string(landmark) + "/" + std::to_string(frame)};
}

Eigen::Vector2d FaultSource::DrawVector(RandomStream* stream) const {
  const double angle = stream->Uniform(0, 2 * std::numbers::pi);
  const double size = config_.outlier_px * stream->Uniform(0.5, 1.5);
  return {size * std::cos(angle), size * std::sin(angle)};
}

TrackFault FaultSource::OfTrack(int landmark, int frame) const {
  TrackFault fault;
  if (config_.outlier_rate <= 0 || !config_.OutliersAreTracks()) {
    return fault;
  }
  RandomStream stream = Stream("track_outliers", landmark, frame);
  fault.wrong = stream.Chance(config_.outlier_rate);
  if (!fault.wrong) {
    return fault;
  }
  const bool mixed = config_.outlier_kind == SimOutlierKind::kMixed;
  fault.kind = mixed ? kKinds[static_cast<std::size_t>(stream.Below(kKinds.size()))] : config_.outlier_kind;
  const bool later = fault.kind == SimOutlierKind::kJump || fault.kind == SimOutlierKind::kSwap;
  const int onset = 1 + static_cast<int>(stream.Below(kOnsets));
  fault.onset = later ? onset : 0;
  fault.jump_px = DrawVector(&stream);
  fault.drift_px_per_s = DrawVector(&stream);
  const double heading = stream.Uniform(0, 2 * std::numbers::pi);
  const double speed = config_.outlier_speed_mps * stream.Uniform(0.5, 1.5);
  fault.velocity_W_mps << speed * std::cos(heading), speed * std::sin(heading), 0;
  return fault;
}

bool FaultSource::OfObservation(int landmark, int frame) const {
  return config_.outlier_rate > 0 && !config_.OutliersAreTracks() &&
         Stream("outliers", landmark, frame).Chance(config_.outlier_rate);
}

Eigen::Vector2d FaultSource::Jump(int landmark, int frame) const {
  RandomStream stream = Stream("outlier_jump", landmark, frame);
  return DrawVector(&stream);
}

Eigen::Vector2d FaultSource::AnyPixel(int landmark, int frame, int width_px, int height_px) const {
  RandomStream stream = Stream("outlier_pixel", landmark, frame);
  const double u = stream.Uniform(0, width_px - 1.0);
  const double v = stream.Uniform(0, height_px - 1.0);
  return {u, v};
}

SimPull::SimPull(const SimulatorConfig& config, std::uint64_t seed)
    : start_s_(config.fault_start_s), duration_s_(config.fault_duration_s) {
  pulls_ = config.fault == SimFaultKind::kGnssRamp || config.fault == SimFaultKind::kGnssRampNoRates;
  moves_rates_ = config.fault == SimFaultKind::kGnssRamp;
  const double heading = RandomStream(seed, "fault/gnss").Uniform(0, 2 * std::numbers::pi);
  velocity_W_mps_ = config.fault_ramp_mps * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0);
}

Eigen::Vector3d SimPull::At(double time_s) const {
  return pulls_ ? Eigen::Vector3d(std::clamp(time_s - start_s_, 0.0, duration_s_) * velocity_W_mps_)
                : Eigen::Vector3d::Zero();
}

void ApplyFault(const SimulatorConfig& config, std::uint64_t seed, TimeNs start_ns, Dataset* dataset) {
  const FaultSpan span(config, start_ns);
  const auto fails = [=](TimeNs stamp_ns) { return span.Contains(stamp_ns); };
  ApplyToTracks(config, seed, "", fails, &dataset->frames);
  for (std::size_t i = 0; i < dataset->extra_cameras.size(); ++i) {
    ApplyToTracks(config, seed, "/cam" + std::to_string(i + 1), fails, &dataset->extra_cameras[i].frames);
  }
  ApplyImuFault(config, seed, span, &dataset->imu);
  if (config.fault == SimFaultKind::kFrameDrops) {
    Drop(fails, config.fault_drop_rate, seed, "", std::identity(), &dataset->camera_stamps);
  }
  if (config.fault == SimFaultKind::kCameraClock) {
    const TimeNs jump_ns = SecondsToNs(config.fault_clock_jump_s);
    for (TrackFrame& frame : dataset->frames) {
      frame.stamp_ns += frame.stamp_ns >= span.begin_ns ? jump_ns : 0;
    }
  }
}

}  // namespace alidade
