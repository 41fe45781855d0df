#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "core/time.h"
#include "gnss/alignment/state_history.h"

namespace alidade {

/// Pairs messages, whose `stamp_ns` is IMU time, with the visual-inertial estimate at their times. A message
/// waits until a state reaches it, but no longer than the window. One that no two states embrace
/// (StateHistory) is let go: it came before the first state or within a silence.
template <typename Message>
class StateMatcher {
 public:
  struct Match {
    AlignmentState state;  ///< at the message's stamp
    Message message;
  };

  explicit StateMatcher(double window_s) : window_s_(window_s) {}

  /// Rising stamps; another state is passed over.
  void AddState(AlignmentState state) { states_.Add(std::move(state)); }

  /// Rising stamps. Messages older than the window before this one go.
  void AddMessage(Message message) {
    const TimeNs newest_ns = message.stamp_ns;
    waiting_.push_back(std::move(message));
    DropOld(newest_ns);
  }

  /// The oldest message that has a state; nothing when those that are left have to wait.
  [[nodiscard]] std::optional<Match> Next() {
    while (!waiting_.empty() && states_.Reaches(waiting_.front().stamp_ns)) {
      Message message = std::move(waiting_.front());
      waiting_.pop_front();
      if (const std::optional<AlignmentState> state = states_.At(message.stamp_ns)) {
        return Match{*state, std::move(message)};
      }
    }
    return std::nullopt;
  }

  /// Messages that are older than the window before `newest_ns` go: without a state nothing else bounds them.
  void DropOld(TimeNs newest_ns) {
    while (!waiting_.empty() && SecondsBetween(waiting_.front().stamp_ns, newest_ns) > window_s_) {
      waiting_.pop_front();
    }
  }

  /// The trajectory was lost, and the next one stands elsewhere. Of the messages that wait, those before its
  /// first state go as that comes; one of just that time is its own.
  void ForgetStates() { states_ = StateHistory(); }

  /// Messages that wait.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] const StateHistory& states() const { return states_; }

 private:
  double window_s_;
  StateHistory states_;
  std::deque<Message> waiting_;
};

}  // namespace alidade
