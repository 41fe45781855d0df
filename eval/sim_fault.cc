#include "eval/sim_fault.h"

#include <array>
#include <cmath>
#include <numbers>

namespace alidade {
namespace {

constexpr std::array<SimOutlierKind, 5> kKinds = {SimOutlierKind::kJump, SimOutlierKind::kUniform,
                                                  SimOutlierKind::kSwap, SimOutlierKind::kDrift,
                                                  SimOutlierKind::kMoving};
constexpr std::uint64_t kOnsets = 4;  // 1 to this many frames after the first

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

}  // namespace alidade
