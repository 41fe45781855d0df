#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <string>

#include "eval/files/hash.h"

namespace alidade {

/// Collects numbers as little-endian 64-bit words, whatever the machine, and hashes them in blocks.
class LogHasher {
 public:
  LogHasher() { block_.reserve(kBlock); }

  void Add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) {
      block_.push_back(static_cast<char>(static_cast<unsigned char>(word >> shift)));
    }
    if (block_.size() >= kBlock) {
      Flush();
    }
  }
  void Add(std::int64_t number) { Add(static_cast<std::uint64_t>(number)); }
  void Add(double number) { Add(std::bit_cast<std::uint64_t>(number + 0.0)); }  // -0 counts as 0
  template <typename Derived>
  void Add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index col = 0; col < matrix.cols(); ++col) {
        Add(static_cast<double>(matrix(row, col)));
      }
    }
  }

  std::string Hex() {
    Flush();
    return hash_.Hex();
  }

 private:
  static constexpr size_t kBlock = 1 << 16;

  void Flush() {
    hash_.Add(block_);
    block_.clear();
  }

  Hash hash_;
  std::string block_;
};

}  // namespace alidade
