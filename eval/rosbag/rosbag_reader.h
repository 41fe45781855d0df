#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"
#include "core/time.h"
#include "eval/rosbag/rosbag_record.h"

namespace alidade {

/// A topic of a bag.
struct BagConnection {
  std::string topic;
  std::string type;    ///< "sensor_msgs/Imu"
  std::string md5sum;  ///< of the message's definition
  std::string definition;
};

/// One message of a bag; the views are valid during the call that receives it.
struct BagMessage {
  const BagConnection* connection = nullptr;
  TimeNs received_ns = 0;  ///< when it was recorded
  std::string_view data;
  BagPlace place;
};

/// Result of a scan.
struct BagScan {
  std::int64_t messages = 0;
  std::int64_t chunks = 0;
  std::int64_t damaged = 0;  ///< skipped chunks and records
  bool truncated = false;    ///< the file ends inside a record
  bool indexed = true;       ///< the bag was closed properly
  std::string first_damage;  ///< fault of the first of them
};

/// Reads a ROS 1 bag (format 2.0) front to back without its index, so an unclosed or truncated bag gives all
/// its complete messages. Only one chunk is in memory. The file is not trusted: lengths are checked against
/// the file's size and the limits in rosbag_chunk.h and rosbag_record.h.
class RosbagReader {
 public:
  /// kInput: cannot be read, or is not a bag of format 2.0 (the message mentions format 1.2).
  static Result<RosbagReader> Open(const std::string& path);

  /// Calls `take` for every message in the order of the file; an error of `take` ends the scan and is
  /// returned.
  Result<BagScan> Scan(const std::function<Status(const BagMessage&)>& take);

  /// The message that a scan found at `place`; valid until the next call. One record is cached, so reading
  /// neighbours is cheap. kInput: the record no longer exists.
  Result<std::string_view> ReadAgain(const BagPlace& place);

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct Record {
    std::string header;
    std::string data;
  };
  enum class Next { kRecord, kEnd, kTorn };

  RosbagReader(std::string path, std::ifstream file, std::uint64_t size)
      : path_(std::move(path)), file_(std::move(file)), size_(size) {}

  Next ReadRecord(Record* record);
  [[nodiscard]] bool ReadBlock(std::uint64_t limit, std::string* block);
  /// `offset` is that of `data` in the bytes of the file's record.
  Status TakeRecord(const BagFields& fields, std::string_view data, std::size_t offset,
                    const std::function<Status(const BagMessage&)>& take);
  Status TakeChunk(const BagFields& fields, std::string_view data,
                   const std::function<Status(const BagMessage&)>& take);
  void AddConnection(const BagFields& fields, std::string_view data);
  void Damage(const std::string& what);

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::map<std::uint32_t, BagConnection> connections_;
  BagScan scan_;
  std::uint64_t record_begin_ = 0;  // of the one the scan is in
  std::optional<std::uint64_t> kept_begin_;
  std::string kept_;  // its bytes, unpacked
};

/// Whether a path names a bag: a file, by its extension.
[[nodiscard]] bool IsBag(const std::string& path);

}  // namespace alidade
