#include "gnss/alignment/state_history.h"

#include <algorithm>
#include <utility>

namespace alidade {
namespace {

constexpr double kMaxStateGapS = 2;  // no interpolation across a longer silence

}  // namespace

void StateHistory::Add(AlignmentState state) {
  if (!states_.empty() && state.stamp_ns <= states_.back().stamp_ns) {
    return;
  }
  if (!states_.empty()) {
    state.acceleration_W =
        (state.nav.v_WB - states_.back().nav.v_WB) / SecondsBetween(states_.back().stamp_ns, state.stamp_ns);
  }
  states_.push_back(std::move(state));
  // A late measurement still finds its states.
  while (states_.size() > 2 && SecondsBetween(states_[1].stamp_ns, states_.back().stamp_ns) > kMaxStateGapS) {
    states_.pop_front();
  }
}

std::optional<AlignmentState> StateHistory::At(TimeNs stamp_ns) const {
  const auto after = std::find_if(states_.begin(), states_.end(),
                                  [&](const AlignmentState& state) { return state.stamp_ns >= stamp_ns; });
  if (after == states_.end() || (after == states_.begin() && after->stamp_ns != stamp_ns)) {
    return std::nullopt;
  }
  const AlignmentState& late = *after;
  const AlignmentState& early = after == states_.begin() ? late : *(after - 1);
  const double span_s = SecondsBetween(early.stamp_ns, late.stamp_ns);
  if (span_s > kMaxStateGapS) {
    return std::nullopt;
  }
  const double share = span_s > 0 ? SecondsBetween(early.stamp_ns, stamp_ns) / span_s : 0;
  const double s2 = share * share;
  const double s3 = s2 * share;
  AlignmentState state = late;
  state.stamp_ns = stamp_ns;
  state.nav.p_WB = early.nav.p_WB + (3 * s2 - 2 * s3) * (late.nav.p_WB - early.nav.p_WB) +
                   span_s * ((s3 - 2 * s2 + share) * early.nav.v_WB + (s3 - s2) * late.nav.v_WB);
  state.nav.v_WB = (1 - share) * early.nav.v_WB + share * late.nav.v_WB;
  state.nav.R_WB = early.nav.R_WB * so3::Exp(share * so3::Log(early.nav.R_WB.transpose() * late.nav.R_WB));
  state.gyro_radps = (1 - share) * early.gyro_radps + share * late.gyro_radps;
  return state;
}

}  // namespace alidade
