#pragma once

#include <string>
#include <string_view>

#include "core/status.h"
#include "gnss/base/text_file.h"

namespace alidade {

/// True when the text begins like Compact RINEX (Hatanaka).
[[nodiscard]] bool IsCompactRinex(std::string_view text);

/// Compact RINEX 1 (of RINEX 2) or 3 (of RINEX 3 and 4) -> RINEX text, blanks at line ends cut.
/// Source: Y. Hatanaka, "A compression format and tools for GNSS observation data", Bulletin of the
/// Geographical Survey Institute 55, 2008.
///
/// A fault in the middle of an arc spoils the differences that follow, so it ends the decoding with an error
/// naming the line; a text that merely stops early gives the epochs that are whole. So does a result of more
/// than `max_bytes`.
Result<std::string> DecodeCompactRinex(const std::string& path, std::string_view text,
                                       std::size_t max_bytes = kMaxTextBytes);

}  // namespace alidade
