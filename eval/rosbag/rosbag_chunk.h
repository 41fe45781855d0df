#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// How the chunks of a bag are packed, by the name that stands in a chunk's header. kLz4 is the LZ4 frame
/// format.
enum class BagCompression { kNone, kBz2, kLz4 };
[[nodiscard]] std::optional<BagCompression> ParseBagCompression(std::string_view name);  // none|bz2|lz4
[[nodiscard]] std::string_view ToString(BagCompression compression);

/// Largest chunk that is unpacked [bytes]; rosbag writes chunks of 768 KiB plus one message.
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 28;

/// Packs a chunk. kOutput: the library refuses.
Result<std::string> PackChunk(BagCompression compression, std::string_view bytes);

/// Unpacks a chunk that says it holds `size` bytes. kInput: it says more than kMaxChunkBytes, does not
/// unpack, or to another size. Allocates no more than that and what the packed bytes warrant.
Result<std::string> UnpackChunk(BagCompression compression, std::string_view packed, std::size_t size);

}  // namespace alidade
