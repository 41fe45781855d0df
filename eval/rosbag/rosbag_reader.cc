#include "eval/rosbag/rosbag_reader.h"

#include <filesystem>

#include "core/regular_file.h"
#include "eval/files/byte_io.h"
#include "eval/rosbag/rosbag_chunk.h"

namespace alidade {
namespace {

Result<std::string> Unpack(const BagFields& fields, std::string_view data) {
  const std::optional<BagCompression> compression = ParseBagCompression(fields.Text("compression"));
  const std::optional<std::uint32_t> size = fields.U32("size");
  if (!compression || !size) {
    return Status::Input("a chunk of unknown compression or size");
  }
  return UnpackChunk(*compression, data, *size);
}

}  // namespace

Result<RosbagReader> RosbagReader::Open(const std::string& path) {
  const Result<std::uintmax_t> size = RegularFileSize(path);
  ALIDADE_RETURN_IF_ERROR(size.status());
  std::ifstream file(path, std::ios::binary);
  std::string magic(kBagMagic.size(), '\0');
  file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (!file || magic != kBagMagic) {
    const bool older = magic.starts_with("#ROS") && magic.find(" V1.") != std::string::npos;
    return Status::Input(path + ": found " + (older ? "a bag of format 1.x" : "no bag") +
                         ", expected a ROS bag of format 2.0 (first line '#ROSBAG V2.0')");
  }
  return RosbagReader(path, std::move(file), *size);
}

bool RosbagReader::ReadBlock(std::uint64_t limit, std::string* block) {
  char raw[4];
  if (!file_.read(raw, sizeof raw)) {
    return false;
  }
  const auto length = ByteReader({raw, sizeof raw}).Read<std::uint32_t>();
  const auto position = static_cast<std::uint64_t>(file_.tellg());
  if (length > limit || position + length > size_) {
    return false;
  }
  block->resize(length);
  return static_cast<bool>(file_.read(block->data(), length));
}

RosbagReader::Next RosbagReader::ReadRecord(Record* record) {
  if (static_cast<std::uint64_t>(file_.tellg()) >= size_) {
    return Next::kEnd;
  }
  return ReadBlock(kMaxRecordHeaderBytes, &record->header) && ReadBlock(kMaxChunkBytes, &record->data)
             ? Next::kRecord
             : Next::kTorn;
}

void RosbagReader::Damage(const std::string& what) {
  if (scan_.damaged++ == 0) {
    scan_.first_damage = what;
  }
}

void RosbagReader::AddConnection(const BagFields& fields, std::string_view data) {
  const std::optional<std::uint32_t> id = fields.U32("conn");
  const std::optional<BagFields> header = BagFields::Parse(data);
  if (!id || !header || header->Text("type").empty()) {
    return Damage("a connection without number or type");
  }
  // Every chunk may repeat it; messages hold on to the first one.
  connections_.try_emplace(
      *id,
      BagConnection{std::string(fields.Text("topic")), std::string(header->Text("type")),
                    std::string(header->Text("md5sum")), std::string(header->Text("message_definition"))});
}

Status RosbagReader::TakeChunk(const BagFields& fields, std::string_view data,
                               const std::function<Status(const BagMessage&)>& take) {
  ++scan_.chunks;
  const Result<std::string> bytes = Unpack(fields, data);
  if (!bytes.ok()) {
    Damage(bytes.message());
    return Status::Ok();
  }
  ByteReader reader(*bytes);
  while (reader.left() > 0) {
    const std::string_view header = reader.Block();
    const std::string_view inner = reader.Block();
    const std::optional<BagFields> inner_fields = BagFields::Parse(header);
    if (!reader.ok() || !inner_fields) {
      Damage("a torn record in a chunk");
      break;
    }
    if (inner_fields->op() == BagOp::kChunk) {
      Damage("a chunk in a chunk");
      continue;
    }
    const auto offset = static_cast<std::size_t>(inner.data() - bytes->data());
    ALIDADE_RETURN_IF_ERROR(TakeRecord(*inner_fields, inner, offset, take));
  }
  return Status::Ok();
}

Status RosbagReader::TakeRecord(const BagFields& fields, std::string_view data, std::size_t offset,
                                const std::function<Status(const BagMessage&)>& take) {
  const std::optional<BagOp> op = fields.op();
  if (op == BagOp::kConnection) {
    AddConnection(fields, data);
  } else if (op == BagOp::kChunk) {
    return TakeChunk(fields, data, take);
  } else if (op == BagOp::kMessage) {
    const std::optional<std::uint32_t> id = fields.U32("conn");
    const std::optional<TimeNs> time = fields.Time("time");
    const auto connection = id ? connections_.find(*id) : connections_.end();
    if (!time || connection == connections_.end()) {
      Damage("a message without connection or time");
      return Status::Ok();
    }
    ++scan_.messages;
    return take({&connection->second, *time, data, {record_begin_, offset, data.size()}});
  } else if (op == BagOp::kBagHeader) {
    ByteReader position(fields.Text("index_pos"));
    scan_.indexed = position.Read<std::uint64_t>() != 0;
  }
  return Status::Ok();
}

Result<BagScan> RosbagReader::Scan(const std::function<Status(const BagMessage&)>& take) {
  scan_ = BagScan();
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(kBagMagic.size()));
  Record record;
  Next next = Next::kEnd;
  while (record_begin_ = static_cast<std::uint64_t>(file_.tellg()),
         (next = ReadRecord(&record)) == Next::kRecord) {
    const std::optional<BagFields> fields = BagFields::Parse(record.header);
    if (!fields) {
      Damage("a record header that is not a list of fields");
      continue;
    }
    ALIDADE_RETURN_IF_ERROR(TakeRecord(*fields, record.data, 0, take));
  }
  scan_.truncated = next == Next::kTorn;
  return scan_;
}

Result<std::string_view> RosbagReader::ReadAgain(const BagPlace& place) {
  if (kept_begin_ != place.record) {
    kept_begin_.reset();
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(place.record));
    Record record;
    const std::optional<BagFields> fields =
        ReadRecord(&record) == Next::kRecord ? BagFields::Parse(record.header) : std::nullopt;
    if (!fields) {
      return Status::Input(path_ + ": no record at byte " + std::to_string(place.record) + " any more");
    }
    if (fields->op() == BagOp::kChunk) {
      Result<std::string> bytes = Unpack(*fields, record.data);
      ALIDADE_RETURN_IF_ERROR(bytes.status());
      kept_ = std::move(*bytes);
    } else {
      kept_ = std::move(record.data);
    }
    kept_begin_ = place.record;
  }
  if (place.offset > kept_.size() || place.length > kept_.size() - place.offset) {
    return Status::Input(path_ + ": the record at byte " + std::to_string(place.record) +
                         " has become shorter");
  }
  return std::string_view(kept_).substr(place.offset, place.length);
}

bool IsBag(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && path.ends_with(".bag");
}

}  // namespace alidade
