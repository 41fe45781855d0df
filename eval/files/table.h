#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/check.h"
#include "core/status.h"
#include "eval/files/byte_io.h"
#include "eval/files/spool_file.h"

namespace alidade {

/// The rows of a long table, to be passed over in order as often as is wanted: a view of rows in memory, or
/// rows in a file without a name (SpoolFile), of which a pass holds one block at a time. A handle: copies
/// share the rows. Rows in a file need, beside them,
///
///   void Encode(const Row&, ByteWriter*);
///   void Decode(ByteReader*, Row*);
template <typename Row>
class Table {
 public:
  /// Of no rows.
  Table() = default;
  /// A view of rows that outlive it and do not change.
  explicit Table(const std::vector<Row>& rows) : rows_(&rows) {}
  /// Empty, to be filled by Add.
  static Table InFile(const std::string& folder) {
    Table table;
    table.spool_ = std::make_shared<Spool>(folder);
    return table;
  }

  /// Precondition: made by InFile. Errors: SpoolFile's.
  Status Add(const Row& row) {
    CHECK(spool_ != nullptr);
    ByteWriter& bytes = spool_->scratch;
    bytes.bytes().clear();
    bytes.Write(std::uint32_t{0});
    Encode(row, &bytes);
    const auto length = static_cast<std::uint32_t>(bytes.bytes().size() - sizeof(std::uint32_t));
    std::memcpy(bytes.bytes().data(), &length, sizeof length);
    ALIDADE_RETURN_IF_ERROR(spool_->file.Append(bytes.bytes()));
    if (spool_->count++ == 0) {
      spool_->first = row;
    }
    spool_->last = row;
    return Status::Ok();
  }

  [[nodiscard]] std::size_t size() const {
    return spool_ != nullptr ? spool_->count : rows_ != nullptr ? rows_->size() : 0;
  }
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// Precondition of both: not empty.
  [[nodiscard]] const Row& front() const { return rows_ != nullptr ? rows_->front() : (*spool_).first; }
  [[nodiscard]] const Row& back() const { return rows_ != nullptr ? rows_->back() : (*spool_).last; }

  /// One walk from the first row to the last. The table must outlive it; rows added meanwhile may be missed.
  class Pass {
   public:
    explicit Pass(const Table& table) : table_(table) {}

    /// The next row, valid until the next call; null at the end. Errors: SpoolFile's.
    Result<const Row*> Next() {
      if (table_.spool_ == nullptr) {
        return next_ < table_.size() ? &(*table_.rows_)[next_++] : static_cast<const Row*>(nullptr);
      }
      if (next_ == table_.spool_->count) {
        return static_cast<const Row*>(nullptr);
      }
      ALIDADE_RETURN_IF_ERROR(Load(sizeof(std::uint32_t)));
      const auto length = ByteReader(std::string_view(block_).substr(begin_)).template Read<std::uint32_t>();
      ALIDADE_RETURN_IF_ERROR(Load(sizeof(std::uint32_t) + length));
      ByteReader reader(std::string_view(block_).substr(begin_ + sizeof(std::uint32_t), length));
      Decode(&reader, &row_);
      CHECK(reader.ok() && reader.left() == 0);
      begin_ += sizeof(std::uint32_t) + length;
      ++next_;
      return static_cast<const Row*>(&row_);
    }

   private:
    /// At least `count` bytes from begin_ on into the block.
    Status Load(std::size_t count) {
      constexpr std::size_t kBlock = std::size_t{1} << 18;
      if (block_.size() - begin_ >= count) {
        return Status::Ok();
      }
      at_ += begin_;
      begin_ = 0;
      ALIDADE_RETURN_IF_ERROR(table_.spool_->file.Read(at_, std::max(count, kBlock), &block_));
      return block_.size() >= count ? Status::Ok() : Status::Output("a temporary file was cut");
    }

    Table table_;
    std::size_t next_ = 0;
    std::uint64_t at_ = 0;   ///< of the block in the file
    std::size_t begin_ = 0;  ///< of the next row in the block
    std::string block_;
    Row row_;
  };

  /// Hands every row to `take`, in order.
  Status ForEach(const std::function<void(const Row&)>& take) const {
    Pass pass(*this);
    while (true) {
      const Result<const Row*> row = pass.Next();
      ALIDADE_RETURN_IF_ERROR(row.status());
      if (*row == nullptr) {
        return Status::Ok();
      }
      take(**row);
    }
  }

 private:
  struct Spool {
    explicit Spool(const std::string& folder) : file(folder) {}
    SpoolFile file;
    std::size_t count = 0;
    Row first, last;
    ByteWriter scratch;
  };

  const std::vector<Row>* rows_ = nullptr;
  std::shared_ptr<Spool> spool_;
};

}  // namespace alidade
