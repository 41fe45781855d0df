#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "eval/rosbag/rosbag_chunk.h"

namespace alidade {

/// Writes an indexed ROS 1 bag (format 2.0) that rosbag can play. The file has a temporary name until Close.
/// Equal calls write equal bytes.
class RosbagWriter {
 public:
  /// kOutput: the file cannot be created.
  static Result<RosbagWriter> Create(const std::string& path, BagCompression compression);
  RosbagWriter(RosbagWriter&& other) noexcept;
  RosbagWriter& operator=(RosbagWriter&&) = delete;
  /// Removes the temporary file of a bag that was not closed.
  ~RosbagWriter();

  /// Number of a new topic; `type` is one of ros_message.h. `latched`: late subscribers get the last
  /// one.
  std::uint32_t AddTopic(const std::string& topic, const std::string& type, bool latched = false);
  /// kOutput: the file cannot be written. kInput: a stamp before 1970 or after 2106, which ROS cannot
  /// represent.
  Status Write(std::uint32_t topic, TimeNs received_ns, std::string_view data);
  /// Writes the index and gives the file its final name. Call once, last.
  Status Close();

 private:
  struct IndexEntry {
    TimeNs stamp_ns = 0;
    std::uint32_t offset = 0;
  };
  struct ChunkInfo {
    std::uint64_t position = 0;
    TimeNs start_ns = 0;
    TimeNs end_ns = 0;
    std::map<std::uint32_t, std::uint32_t> counts;
  };
  struct Connection {
    std::string record;
    bool written = false;  ///< its record has been written to a chunk
  };

  RosbagWriter(std::string path, BagCompression compression)
      : path_(std::move(path)), compression_(compression) {}
  void Put(std::string_view bytes);
  void PutBagHeader(std::uint64_t index_position);
  Status EndChunk();

  std::string path_;
  BagCompression compression_;
  std::ofstream file_;
  bool open_ = false;
  std::uint64_t position_ = 0;
  std::vector<Connection> connections_;
  std::string chunk_;
  std::map<std::uint32_t, std::vector<IndexEntry>> chunk_index_;
  std::vector<ChunkInfo> chunks_;
};

}  // namespace alidade
