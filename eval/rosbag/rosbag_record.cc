#include "eval/rosbag/rosbag_record.h"

#include "eval/files/byte_io.h"

namespace alidade {

std::optional<BagFields> BagFields::Parse(std::string_view header) {
  BagFields fields;
  ByteReader reader(header);
  while (reader.left() > 0) {
    const std::string_view field = reader.Block();
    const std::size_t equals = field.find('=');
    if (!reader.ok() || equals == std::string_view::npos) {
      return std::nullopt;
    }
    fields.fields_[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

std::optional<BagOp> BagFields::op() const {
  const std::string_view value = Text("op");
  return value.size() == 1 ? std::optional(static_cast<BagOp>(value[0])) : std::nullopt;
}

std::optional<std::uint32_t> BagFields::U32(std::string_view name) const {
  ByteReader reader(Text(name));
  const auto value = reader.Read<std::uint32_t>();
  return reader.ok() && reader.left() == 0 ? std::optional(value) : std::nullopt;
}

std::optional<TimeNs> BagFields::Time(std::string_view name) const {
  ByteReader reader(Text(name));
  const TimeNs seconds = reader.Read<std::uint32_t>();
  const TimeNs nanoseconds = reader.Read<std::uint32_t>();
  const bool whole = reader.ok() && reader.left() == 0;
  return whole ? std::optional(seconds * kSecondNs + nanoseconds) : std::nullopt;
}

std::string_view BagFields::Text(std::string_view name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string_view() : found->second;
}

BagFieldWriter::BagFieldWriter(BagOp op) {
  const char value = static_cast<char>(op);
  Text("op", {&value, 1});
}

BagFieldWriter& BagFieldWriter::Text(std::string_view name, std::string_view value) {
  ByteWriter field;
  field.Block(std::string(name) + "=" + std::string(value));
  bytes_ += field.bytes();
  return *this;
}

BagFieldWriter& BagFieldWriter::U32(std::string_view name, std::uint32_t value) {
  ByteWriter bytes;
  bytes.Write(value);
  return Text(name, bytes.bytes());
}

BagFieldWriter& BagFieldWriter::U64(std::string_view name, std::uint64_t value) {
  ByteWriter bytes;
  bytes.Write(value);
  return Text(name, bytes.bytes());
}

BagFieldWriter& BagFieldWriter::Time(std::string_view name, TimeNs stamp_ns) {
  return U64(name, PackRosTime(stamp_ns));
}

std::uint64_t PackRosTime(TimeNs stamp_ns) {
  const auto value = static_cast<std::uint64_t>(stamp_ns);
  constexpr std::uint64_t kSecond = kSecondNs;
  return (value / kSecond) | ((value % kSecond) << 32);
}

}  // namespace alidade
