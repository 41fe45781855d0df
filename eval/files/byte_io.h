#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace alidade {

static_assert(std::endian::native == std::endian::little, "bags are little-endian and copied as they are");

/// Reads little-endian values from the front of untrusted bytes. Reading past the end gives zeros and makes
/// ok() false permanently. Lengths found in the bytes are checked against the remaining size before anything
/// is allocated.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Value>
  [[nodiscard]] Value Read() {
    static_assert(std::is_arithmetic_v<Value>);
    Value value{};
    const std::string_view taken = Take(sizeof(Value));
    if (ok_) {
      std::memcpy(&value, taken.data(), sizeof(Value));
    }
    return value;
  }
  /// The next `count` bytes; empty when there are fewer.
  [[nodiscard]] std::string_view Take(std::size_t count) {
    if (!ok_ || count > bytes_.size()) {
      ok_ = false;
      return {};
    }
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  /// Bytes after their 32-bit length: a ROS string or uint8 array.
  [[nodiscard]] std::string_view Block() { return Take(Read<std::uint32_t>()); }
  /// A ROS array: 32-bit count, then the values.
  template <typename Value>
  [[nodiscard]] std::vector<Value> Array() {
    const std::size_t count = Read<std::uint32_t>();
    const std::string_view taken =
        count <= bytes_.size() / sizeof(Value) ? Take(count * sizeof(Value)) : Take(bytes_.size() + 1);
    std::vector<Value> values(taken.size() / sizeof(Value));
    if (!values.empty()) {
      std::memcpy(values.data(), taken.data(), taken.size());
    }
    return values;
  }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

/// Appends little-endian values.
class ByteWriter {
 public:
  template <typename Value>
  void Write(Value value) {
    static_assert(std::is_arithmetic_v<Value>);
    char raw[sizeof(Value)];
    std::memcpy(raw, &value, sizeof(Value));
    bytes_.append(raw, sizeof(Value));
  }
  void Raw(std::string_view bytes) { bytes_.append(bytes); }
  void Block(std::string_view bytes) {
    Write(static_cast<std::uint32_t>(bytes.size()));
    Raw(bytes);
  }
  template <typename Value>
  void Array(const std::vector<Value>& values) {
    Write(static_cast<std::uint32_t>(values.size()));
    for (const Value value : values) {
      Write(value);
    }
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace alidade
