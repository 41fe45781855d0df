#include "smoother/factors/geometry_cache.h"

#include <algorithm>

namespace alidade {

GeometryCache::GeometryCache(const WindowCalibration& calibration, size_t frames)
    : calibration_(&calibration), camera_(calibration), entries_(frames) {}

const WindowCalibration* GeometryCache::Camera(const double* block) {
  const size_t size = static_cast<size_t>(calibration_->size());
  if (size == 0 || (block_.size() == size && std::equal(block_.begin(), block_.end(), block))) {
    return &camera_;
  }
  block_.clear();
  for (Entry& entry : entries_) {
    entry.valid = false;
  }
  if (!calibration_->At(block, &camera_.mean)) {
    return nullptr;
  }
  block_.assign(block, block + size);
  return &camera_;
}

const FrameGeometry& GeometryCache::Frame(const WindowFrame& frame, const double* nav) {
  Entry& entry = entries_[static_cast<size_t>(frame.index)];
  if (!entry.valid || !std::equal(entry.nav.begin(), entry.nav.end(), nav)) {
    std::copy_n(nav, kNavAmbientSize, entry.nav.begin());
    entry.geometry = MakeGeometry(frame, UnpackNavState(nav), camera_.mean);
    entry.valid = true;
  }
  return entry.geometry;
}

}  // namespace alidade
