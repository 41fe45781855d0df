#include "eval/render/image_fault.h"

#include <algorithm>

namespace alidade {

ImageFault::ImageFault(const SimulatorConfig& config, TimeNs start_ns, const std::vector<TimeNs>& stamps)
    : kind_(config.fault), span_(config, start_ns), blur_px_(config.fault_blur_px) {
  const auto index_of = [&](TimeNs stamp_ns) {
    return static_cast<std::size_t>(std::lower_bound(stamps.begin(), stamps.end(), stamp_ns) -
                                    stamps.begin());
  };
  first_ = index_of(span_.begin_ns);
  after_ = index_of(span_.end_ns);
}

std::size_t ImageFault::Shown(std::size_t index) const {
  return kind_ == SimFaultKind::kFrozen && index >= first_ && index < after_ ? first_ : index;
}

void ImageFault::Apply(TimeNs stamp_ns, Shot* shot) const {
  if (!span_.Contains(stamp_ns)) {
    return;
  }
  switch (kind_) {
    case SimFaultKind::kBlackout:
    case SimFaultKind::kBlackoutAndImu:
      shot->light = 0;
      break;
    case SimFaultKind::kGlare:
      shot->light *= kGlareLight;
      break;
    case SimFaultKind::kBlur:
      shot->blur_px = blur_px_;
      break;
    default:
      break;
  }
}

}  // namespace alidade
