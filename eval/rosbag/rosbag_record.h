#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/time.h"

namespace alidade {

// ROS bag format 2.0 (wiki.ros.org/Bags/Format/2.0): a line of text, then records
//   <u32 length> <header: fields "<u32 length>name=value"> <u32 length> <data>
inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
/// The record of the bag header, data padded with blanks, takes this many bytes [bytes].
inline constexpr std::size_t kBagHeaderBytes = 4096;
/// Longest accepted header of a record [bytes].
inline constexpr std::size_t kMaxRecordHeaderBytes = std::size_t{1} << 20;

enum class BagOp : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// Position of a message in its file, to read it again.
struct BagPlace {
  std::uint64_t record = 0;  ///< byte at which its record, or that of its chunk, begins
  std::size_t offset = 0;    ///< in the bytes of the record, those of a chunk unpacked
  std::size_t length = 0;
};

/// Fields of a record's header; the values are views into the header's bytes.
class BagFields {
 public:
  /// Empty when a field exceeds the header or has no '='.
  static std::optional<BagFields> Parse(std::string_view header);

  [[nodiscard]] std::optional<BagOp> op() const;
  /// A value of exactly this width.
  [[nodiscard]] std::optional<std::uint32_t> U32(std::string_view name) const;
  [[nodiscard]] std::optional<TimeNs> Time(std::string_view name) const;
  /// Empty when it is missing.
  [[nodiscard]] std::string_view Text(std::string_view name) const;

 private:
  std::map<std::string_view, std::string_view> fields_;
};

/// Builds the bytes of a record's header.
class BagFieldWriter {
 public:
  explicit BagFieldWriter(BagOp op);
  BagFieldWriter() = default;  ///< fields alone, as in the data of a connection record
  BagFieldWriter& Text(std::string_view name, std::string_view value);
  BagFieldWriter& U32(std::string_view name, std::uint32_t value);
  BagFieldWriter& U64(std::string_view name, std::uint64_t value);
  BagFieldWriter& Time(std::string_view name, TimeNs stamp_ns);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// A ROS time, seconds and nanoseconds as two 32-bit numbers, packed into one.
[[nodiscard]] std::uint64_t PackRosTime(TimeNs stamp_ns);

}  // namespace alidade
