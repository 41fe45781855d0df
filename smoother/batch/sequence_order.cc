#include "smoother/batch/sequence_order.h"

#include <algorithm>

#include "core/check.h"

namespace alidade {

SequenceOrder::SequenceOrder(const SequenceProblem& problem)
    : at(problem.frames.size()), between(problem.frames.size()), begins(problem.frames.size()) {
  for (const std::unique_ptr<WindowTerm>& term : problem.terms) {
    int oldest = static_cast<int>(problem.frames.size());
    int newest = -1;
    for (const TermPart& part : term->parts()) {
      if (part.of.kind == Unknown::Kind::kFrame || part.of.kind == Unknown::Kind::kClock) {
        oldest = std::min(oldest, part.of.index);
        newest = std::max(newest, part.of.index);
      }
    }
    CHECK(newest >= 0 && newest <= oldest + 1) << "a term concerns one frame, or two that follow each other";
    const auto frame = static_cast<size_t>(newest);
    (oldest == newest ? at : between)[frame].push_back(term.get());
    for (const TermPart& part : term->parts()) {
      if (part.of.kind != Unknown::Kind::kLandmark) {
        continue;
      }
      const auto landmark = static_cast<size_t>(part.of.index);
      last_frame.resize(std::max(last_frame.size(), landmark + 1), -1);
      CHECK(oldest == newest && newest >= last_frame[landmark])
          << "the terms of a landmark concern one frame each and come in time order";
      if (last_frame[landmark] < 0) {
        begins[frame].push_back(part.of.index);
      }
      last_frame[landmark] = newest;
    }
  }
}

}  // namespace alidade
