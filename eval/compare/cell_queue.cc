#include "eval/compare/cell_queue.h"

#include <algorithm>

namespace alidade {

CellQueue::CellQueue(const std::vector<Input>& inputs) {
  for (const Input& input : inputs) {
    inputs_.push_back({input.first, input.end, !input.may_track});
    first_.push_back(input.first);
    left_ += input.end - input.first;
  }
}

CellQueue::State& CellQueue::Of(size_t cell) {
  const auto after = std::upper_bound(first_.begin(), first_.end(), cell);
  return inputs_[static_cast<size_t>(after - first_.begin()) - 1];
}

std::optional<size_t> CellQueue::Take(State* input) {
  if (input->next == input->end) {
    return std::nullopt;
  }
  --left_;
  return input->next++;
}

std::optional<size_t> CellQueue::Next(std::optional<size_t> last) {
  if (last) {
    if (const std::optional<size_t> cell = Take(&Of(*last))) {
      return cell;
    }
  }
  while (begun_ < inputs_.size()) {
    if (const std::optional<size_t> cell = Take(&inputs_[begun_++])) {
      return cell;
    }
  }
  State* most = nullptr;
  for (State& input : inputs_) {
    const size_t left = input.open ? input.end - input.next : 0;
    if (left > 0 && (most == nullptr || left > most->end - most->next)) {
      most = &input;
    }
  }
  return most == nullptr ? std::nullopt : Take(most);
}

void CellQueue::Ended(size_t cell) {
  Of(cell).open = true;
}

}  // namespace alidade
