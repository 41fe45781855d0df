#include "eval/rosbag/rosbag_chunk.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>

namespace alidade {
namespace {

/// Room is made in steps: a size that a file merely claims must not be allocated before bytes back it.
constexpr std::size_t kStep = std::size_t{1} << 20;

/// bzlib and lz4 take no const input, or unsigned sizes; both leave the input alone.
char* Mutable(std::string_view bytes) {
  return const_cast<char*>(bytes.data());
}

Result<std::string> PackBz2(std::string_view bytes) {
  // bzip2's manual: one per cent and 600 bytes more than the input always suffice.
  std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned>(packed.size());
  constexpr int kBlockSize100k = 9;
  const int code = BZ2_bzBuffToBuffCompress(packed.data(), &size, Mutable(bytes),
                                            static_cast<unsigned>(bytes.size()), kBlockSize100k, 0, 0);
  if (code != BZ_OK) {
    return Status::Output("bz2: error " + std::to_string(code) + " on packing a chunk");
  }
  packed.resize(size);
  return packed;
}

LZ4F_preferences_t Lz4Preferences() {
  LZ4F_preferences_t preferences{};
  // What ROS's own lz4 reader takes: independent blocks and a checksum of the content.
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  return preferences;
}

Result<std::string> PackLz4(std::string_view bytes) {
  const LZ4F_preferences_t preferences = Lz4Preferences();
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size) != 0) {
    return Status::Output(std::string("lz4: ") + LZ4F_getErrorName(size) + " on packing a chunk");
  }
  packed.resize(size);
  return packed;
}

Result<std::string> UnpackBz2(std::string_view packed, std::size_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    return Status::Input("bz2: cannot start to unpack");
  }
  std::string bytes;
  stream.next_in = Mutable(packed);
  stream.avail_in = static_cast<unsigned>(packed.size());
  int code = BZ_OK;
  while (code == BZ_OK && bytes.size() <= size) {
    const std::size_t done = bytes.size();
    bytes.resize(done + std::min(kStep, size - done + 1));
    stream.next_out = bytes.data() + done;
    stream.avail_out = static_cast<unsigned>(bytes.size() - done);
    code = BZ2_bzDecompress(&stream);
    const bool stuck = code == BZ_OK && stream.avail_in == 0 && stream.avail_out != 0;
    bytes.resize(bytes.size() - stream.avail_out);
    if (stuck) {
      break;
    }
  }
  BZ2_bzDecompressEnd(&stream);
  if (code != BZ_STREAM_END) {
    return Status::Input("bz2: does not unpack (code " + std::to_string(code) + ")");
  }
  return bytes;
}

Result<std::string> UnpackLz4(std::string_view packed, std::size_t size) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    return Status::Input("lz4: cannot start to unpack");
  }
  std::string bytes;
  std::size_t hint = 1;
  while (hint != 0 && LZ4F_isError(hint) == 0 && bytes.size() <= size) {
    const std::size_t done = bytes.size();
    bytes.resize(done + std::min(kStep, size - done + 1));
    std::size_t written = bytes.size() - done;
    std::size_t read = packed.size();
    hint = LZ4F_decompress(context, bytes.data() + done, &written, packed.data(), &read, nullptr);
    packed.remove_prefix(read);
    bytes.resize(done + written);
    if (written == 0 && read == 0) {
      break;
    }
  }
  LZ4F_freeDecompressionContext(context);
  if (hint != 0) {
    return Status::Input(std::string("lz4: does not unpack") +
                         (LZ4F_isError(hint) != 0 ? std::string(" (") + LZ4F_getErrorName(hint) + ")" : ""));
  }
  return bytes;
}

}  // namespace

std::optional<BagCompression> ParseBagCompression(std::string_view name) {
  for (const BagCompression compression :
       {BagCompression::kNone, BagCompression::kBz2, BagCompression::kLz4}) {
    if (name == ToString(compression)) {
      return compression;
    }
  }
  return std::nullopt;
}

std::string_view ToString(BagCompression compression) {
  switch (compression) {
    case BagCompression::kBz2:
      return "bz2";
    case BagCompression::kLz4:
      return "lz4";
    case BagCompression::kNone:
      break;
  }
  return "none";
}

Result<std::string> PackChunk(BagCompression compression, std::string_view bytes) {
  switch (compression) {
    case BagCompression::kBz2:
      return PackBz2(bytes);
    case BagCompression::kLz4:
      return PackLz4(bytes);
    case BagCompression::kNone:
      break;
  }
  return std::string(bytes);
}

Result<std::string> UnpackChunk(BagCompression compression, std::string_view packed, std::size_t size) {
  if (size > kMaxChunkBytes) {
    return Status::Input("a chunk of " + std::to_string(size) + " bytes, expected at most " +
                         std::to_string(kMaxChunkBytes));
  }
  Result<std::string> bytes = compression == BagCompression::kBz2 ? UnpackBz2(packed, size)
                              : compression == BagCompression::kLz4
                                  ? UnpackLz4(packed, size)
                                  : Result<std::string>(std::string(packed));
  if (bytes.ok() && bytes->size() != size) {
    return Status::Input("a chunk unpacks to another size than the " + std::to_string(size) +
                         " bytes that its header states");
  }
  return bytes;
}

}  // namespace alidade
