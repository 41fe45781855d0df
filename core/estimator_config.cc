#include "core/estimator_config.h"

namespace alidade {

void EstimatorConfig::Describe(ConfigVisitor& visitor) {
  visitor.Text({"name", "-", "name of the estimator in tables and paths"}, &name);
  visitor.Enumeration(
      {"backend", "-", "which back end runs"}, &backend,
      {{"filter", Backend::kFilter}, {"smoother", Backend::kSmoother}, {"batch", Backend::kBatch}});
  ForEachSection([&](const char* key, const char* purpose, auto& section) {
    visitor.Section(key, purpose, [&] { section.Describe(visitor); });
  });
}

Status EstimatorConfig::Validate() const {
  if (filter.min_observations > filter.window + 1) {
    return Status::Config("filter.min_observations: " + std::to_string(filter.min_observations) +
                          " views never fit a window of " + std::to_string(filter.window) +
                          " clones and the newest frame");
  }
  if (filter.first_estimates && filter.track_memory != TrackMemoryPolicy::kNone) {
    return Status::Config(
        "filter.first_estimates: true, but memories of tracks are linearised at the current estimates; "
        "expected false, or filter.track_memory: none");
  }
  if (vision.min_depth_m >= vision.max_depth_m) {
    return Status::Config("vision.min_depth_m: must be less than vision.max_depth_m");
  }
  if (frontend.template_px != 0 && frontend.template_px < 5) {
    return Status::Config("frontend.template_px: " + std::to_string(frontend.template_px) +
                          " px are too few to estimate the deformation; expected 0, or at least 5");
  }
  if (calibration.line_delay && !vision.rolling_shutter) {
    return Status::Config(
        "calibration.line_delay: true, but without a rolling shutter there is none; expected false, or "
        "vision.rolling_shutter: true");
  }
  if (calibration.any() && backend == Backend::kBatch) {
    return Status::Config(
        "calibration: the batch back end takes the camera as given; expected extrinsics, time_offset, "
        "line_delay and intrinsics false, or backend: filter or smoother");
  }
  if (const Status systems = gnss.corrections.Validate(); !systems.ok()) {
    return Status::Config("gnss." + systems.message());
  }
  return Status::Ok();
}

}  // namespace alidade
