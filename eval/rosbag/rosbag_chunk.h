#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// Compression of the chunks of a bag, by the name in a chunk's header. kLz4 is the LZ4 frame format.
enum class BagCompression { kNone, kBz2, kLz4 };
[[nodiscard]] std::optional<BagCompression> ParseBagCompression(std::string_view name);  // none|bz2|lz4
[[nodiscard]] std::string_view ToString(BagCompression compression);

/// Largest chunk that is decompressed [bytes]; rosbag writes chunks of 768 KiB plus one message.
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 28;

/// Compresses a chunk. kOutput: the library fails.
Result<std::string> PackChunk(BagCompression compression, std::string_view bytes);

/// Decompresses a chunk whose stated size is `size` bytes. kInput: the stated size exceeds kMaxChunkBytes, or
/// decompression fails or gives another size. Allocates no more than the stated size and what the compressed
/// bytes can yield.
Result<std::string> UnpackChunk(BagCompression compression, std::string_view packed, std::size_t size);

}  // namespace alidade
