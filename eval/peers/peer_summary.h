#pragma once

#include <optional>
#include <string>

#include "eval/peers/peer_feed.h"
#include "eval/peers/peer_run.h"

namespace alidade {

/// What a driver reports of a run: when, after the first frame, the first pose came and the alignment with
/// GNSS, and Completion of the sequence.
std::string SummaryText(const PeerSequence& sequence, const PeerRun& run,
                        const std::optional<TimeNs>& aligned_ns);

}  // namespace alidade
