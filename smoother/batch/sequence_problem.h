#pragma once

#include <memory>
#include <span>

#include "smoother/solve/window_term.h"

namespace alidade {

/// What a batch solve estimates: states of frames, and the terms over them.
struct SequenceProblem {
  std::span<const std::unique_ptr<WindowFrame>> frames;
  /// Each concerns one frame and landmarks, or two consecutive frames.
  std::span<const std::unique_ptr<WindowTerm>> terms;
};

}  // namespace alidade
