#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace alidade {

/// Hands out the cells of a comparison to workers, so that each input is loaded by few of them: a worker gets
/// cells of the input that it holds, then those of an input that nobody has begun, then part of the input
/// with the most cells left. The images of an input are tracked by one worker, while the others wait for what
/// it keeps.
class CellQueue {
 public:
  struct Input {
    size_t first = 0, end = 0;  ///< its cells
    bool may_track = false;     ///< loading it may take long; what it makes is kept
  };
  explicit CellQueue(const std::vector<Input>& inputs);

  /// The next cell for a worker that ran `last` before; none: wait for Ended, or nothing is left.
  std::optional<size_t> Next(std::optional<size_t> last);
  /// The cell was run, or its worker has died.
  void Ended(size_t cell);
  [[nodiscard]] size_t size() const { return left_; }  ///< not yet handed out

 private:
  struct State {
    size_t next = 0, end = 0;
    bool open = false;  ///< to every worker
  };
  [[nodiscard]] State& Of(size_t cell);
  std::optional<size_t> Take(State* input);

  std::vector<State> inputs_;
  std::vector<size_t> first_;  ///< cells of inputs_
  size_t begun_ = 0;           ///< inputs_ below it have been begun
  size_t left_ = 0;
};

}  // namespace alidade
