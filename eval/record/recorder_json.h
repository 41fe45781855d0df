#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "eval/run/session_event.h"

namespace alidade {

/// A member of the expected type, or `fallback`: what an older version did not write.
template <typename T>
[[nodiscard]] T JsonMember(const nlohmann::ordered_json& json, const char* key, T fallback) {
  try {
    return json.is_object() ? json.value(key, fallback) : fallback;
  } catch (const nlohmann::ordered_json::exception&) {
    return fallback;
  }
}

/// How the run of a run.json came to stand in the ENU frame or in that of a position sensor, if it did.
[[nodiscard]] std::optional<GlobalFrame> ReadGlobalFrame(const nlohmann::ordered_json& run);

}  // namespace alidade
