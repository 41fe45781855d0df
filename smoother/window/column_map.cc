#include "smoother/window/column_map.h"

#include <algorithm>

namespace alidade {

void ColumnMap::Add(const Unknown& unknown, Index size) {
  Group& group = groups_[static_cast<size_t>(unknown.kind)];
  if (group.ranges.empty()) {
    group.first_index = unknown.index;
  }
  const int before = group.first_index - unknown.index;
  if (before > 0) {
    group.ranges.insert(group.ranges.begin(), static_cast<size_t>(before), {});
    group.first_index = unknown.index;
  }
  const auto at = static_cast<size_t>(unknown.index - group.first_index);
  group.ranges.resize(std::max(group.ranges.size(), at + 1));
  group.ranges[at] = {size_, size};
  size_ += size;
}

ColumnMap::Range ColumnMap::Find(const Unknown& unknown) const {
  const Group& group = groups_[static_cast<size_t>(unknown.kind)];
  const int at = unknown.index - group.first_index;
  return at >= 0 && at < static_cast<int>(group.ranges.size()) ? group.ranges[static_cast<size_t>(at)]
                                                               : Range{};
}

}  // namespace alidade
