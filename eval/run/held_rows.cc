#include "eval/run/held_rows.h"

#include <algorithm>

namespace alidade {

void HeldRows::Restart(TimeNs stamp_ns, const Eigen::Vector3d& other) {
  longest_ = frozen_ ? longest_ : std::max(longest_, rows_);
  frozen_ = false;
  rows_ = 0;
  since_ns_ = stamp_ns;
  low_ = high_ = other;
}

void HeldRows::Add(const Eigen::Vector3d& other) {
  ++rows_;
  low_ = low_.cwiseMin(other);
  high_ = high_.cwiseMax(other);
}

void HeldRows::Judge(bool may_be_fault, TimeNs stamp_ns) {
  frozen_ = frozen_ || (may_be_fault && rows_ >= std::max(kFrozen, 3 * longest_) &&
                        SecondsBetween(since_ns_, stamp_ns) >= kFrozenS);
}

}  // namespace alidade
