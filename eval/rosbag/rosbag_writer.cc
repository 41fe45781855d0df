#include "eval/rosbag/rosbag_writer.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "eval/files/byte_io.h"
#include "eval/rosbag/ros_message.h"
#include "eval/rosbag/rosbag_record.h"

namespace alidade {
namespace {

/// rosbag's own size of a chunk [bytes].
constexpr std::size_t kChunkBytes = 768 * 1024;
constexpr TimeNs kEndOfRosTime = (TimeNs{1} << 32) * kSecondNs;

std::string Record(const BagFieldWriter& fields, std::string_view data) {
  ByteWriter bytes;
  bytes.Block(fields.bytes());
  bytes.Block(data);
  return std::move(bytes.bytes());
}

std::string TemporaryName(const std::string& path) {
  return path + ".part";
}

}  // namespace

Result<RosbagWriter> RosbagWriter::Create(const std::string& path, BagCompression compression) {
  RosbagWriter writer(path, compression);
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) {
    std::filesystem::create_directories(folder, error);
  }
  errno = 0;
  writer.file_.open(TemporaryName(path), std::ios::binary | std::ios::trunc);
  if (!writer.file_) {
    return Status::Output(path + ": cannot be written: " + std::strerror(errno));
  }
  writer.open_ = true;
  writer.Put(kBagMagic);
  writer.PutBagHeader(0);
  return writer;
}

RosbagWriter::RosbagWriter(RosbagWriter&& other) noexcept
    : path_(std::move(other.path_)),
      compression_(other.compression_),
      file_(std::move(other.file_)),
      open_(std::exchange(other.open_, false)),
      position_(other.position_),
      connections_(std::move(other.connections_)),
      chunk_(std::move(other.chunk_)),
      chunk_index_(std::move(other.chunk_index_)),
      chunks_(std::move(other.chunks_)) {}

RosbagWriter::~RosbagWriter() {
  if (open_) {
    file_.close();
    std::error_code ignored;
    std::filesystem::remove(TemporaryName(path_), ignored);
  }
}

void RosbagWriter::Put(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

void RosbagWriter::PutBagHeader(std::uint64_t index_position) {
  const BagFieldWriter fields = BagFieldWriter(BagOp::kBagHeader)
                                    .U64("index_pos", index_position)
                                    .U32("conn_count", static_cast<std::uint32_t>(connections_.size()))
                                    .U32("chunk_count", static_cast<std::uint32_t>(chunks_.size()));
  Put(Record(fields, std::string(kBagHeaderBytes - 8 - fields.bytes().size(), ' ')));
}

std::uint32_t RosbagWriter::AddTopic(const std::string& topic, const std::string& type, bool latched) {
  const auto number = static_cast<std::uint32_t>(connections_.size());
  BagFieldWriter data;
  data.Text("topic", topic)
      .Text("type", type)
      .Text("md5sum", RosMd5(type))
      .Text("message_definition", RosDefinition(type));
  if (latched) {
    data.Text("latching", "1");
  }
  const BagFieldWriter fields = BagFieldWriter(BagOp::kConnection).U32("conn", number).Text("topic", topic);
  connections_.push_back({Record(fields, data.bytes())});
  return number;
}

Status RosbagWriter::Write(std::uint32_t topic, TimeNs received_ns, std::string_view data) {
  if (received_ns < 0 || received_ns >= kEndOfRosTime) {
    return Status::Input(path_ + ": stamp " + std::to_string(received_ns) +
                         " ns, expected a stamp from 1970 to 2106, the range of a ROS time");
  }
  Connection& connection = connections_[topic];
  if (!connection.written) {
    chunk_ += connection.record;
    connection.written = true;
  }
  chunk_index_[topic].push_back({received_ns, static_cast<std::uint32_t>(chunk_.size())});
  chunk_ += Record(BagFieldWriter(BagOp::kMessage).U32("conn", topic).Time("time", received_ns), data);
  return chunk_.size() >= kChunkBytes ? EndChunk() : Status::Ok();
}

Status RosbagWriter::EndChunk() {
  if (chunk_.empty()) {
    return Status::Ok();
  }
  Result<std::string> packed = PackChunk(compression_, chunk_);
  ALIDADE_RETURN_IF_ERROR(packed.status());
  ChunkInfo info{position_, INT64_MAX, INT64_MIN, {}};
  Put(Record(BagFieldWriter(BagOp::kChunk)
                 .Text("compression", ToString(compression_))
                 .U32("size", static_cast<std::uint32_t>(chunk_.size())),
             *packed));
  for (const auto& [topic, entries] : chunk_index_) {
    ByteWriter data;
    for (const IndexEntry& entry : entries) {
      data.Write(PackRosTime(entry.stamp_ns));
      data.Write(entry.offset);
      info.start_ns = std::min(info.start_ns, entry.stamp_ns);
      info.end_ns = std::max(info.end_ns, entry.stamp_ns);
    }
    info.counts[topic] = static_cast<std::uint32_t>(entries.size());
    Put(Record(BagFieldWriter(BagOp::kIndex)
                   .U32("ver", 1)
                   .U32("conn", topic)
                   .U32("count", static_cast<std::uint32_t>(entries.size())),
               data.bytes()));
  }
  chunks_.push_back(std::move(info));
  chunk_.clear();
  chunk_index_.clear();
  return file_ ? Status::Ok() : Status::Output(path_ + ": cannot be written (disk full?)");
}

Status RosbagWriter::Close() {
  ALIDADE_RETURN_IF_ERROR(EndChunk());
  const std::uint64_t index_position = position_;
  for (const Connection& connection : connections_) {
    Put(connection.record);
  }
  for (const ChunkInfo& chunk : chunks_) {
    ByteWriter data;
    for (const auto& [topic, count] : chunk.counts) {
      data.Write(topic);
      data.Write(count);
    }
    Put(Record(BagFieldWriter(BagOp::kChunkInfo)
                   .U32("ver", 1)
                   .U64("chunk_pos", chunk.position)
                   .Time("start_time", chunk.start_ns)
                   .Time("end_time", chunk.end_ns)
                   .U32("count", static_cast<std::uint32_t>(chunk.counts.size())),
               data.bytes()));
  }
  file_.seekp(static_cast<std::streamoff>(kBagMagic.size()));
  PutBagHeader(index_position);
  file_.close();
  std::error_code error;
  if (file_) {
    std::filesystem::rename(TemporaryName(path_), path_, error);
  }
  if (!file_ || error) {
    return Status::Output(path_ + ": cannot be written (disk full?)");
  }
  open_ = false;
  return Status::Ok();
}

}  // namespace alidade
