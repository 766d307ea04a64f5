// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a LAZ file, read through a window of fixed size, however many there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace ptin::laz {

/// A file, read at any position.
struct Source {
  std::string path;
  std::uint64_t bytes = 0;
  /// Fills `into` with the bytes from `offset` on.  @throws Error io_error
  std::function<void(std::uint64_t offset, std::span<unsigned char> into)> read;
};

/// Thrown where compressed bytes cannot be what a writer of LAZ wrote. Whoever knows which points
/// they are makes an Error of it.
struct DamagedBytes {
  const char* fault;  ///< A clause that "the chunk is damaged: " precedes.
};

/// Bytes of a part of a file, one after the other.
class ByteWindow {
 public:
  /// @param source  Must outlive this.
  explicit ByteWindow(const Source& source) : source_(&source) {}

  /// Begins with the byte at `begin`. REQUIRES: begin <= end <= source.bytes.
  void open(std::uint64_t begin, std::uint64_t end) noexcept {
    next_ = begin;
    end_ = end;
    at_ = filled_ = nullptr;
  }
  /// @throws DamagedBytes  there is none left; Error io_error
  [[nodiscard]] unsigned char next() {
    if (at_ == filled_) [[unlikely]] {
      fill();
    }
    return *at_++;
  }
  /// Bytes that were not read.
  [[nodiscard]] std::uint64_t left() const noexcept {
    return end_ - next_ + static_cast<std::uint64_t>(filled_ - at_);
  }

 private:
  void fill();

  const Source* source_;
  std::vector<unsigned char> buffer_;
  const unsigned char* at_ = nullptr;
  const unsigned char* filled_ = nullptr;  ///< The end of what the buffer holds.
  std::uint64_t next_ = 0, end_ = 0;       ///< What is still to be read into the buffer.
};

}  // namespace ptin::laz
