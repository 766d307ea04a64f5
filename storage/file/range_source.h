// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes that lie elsewhere and are read in ranges: an object on a web server, in a store of objects.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ptin {

/// A part of a file: `bytes` bytes from `offset` on.
struct ByteRange {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// A range, and where its bytes go.
struct RangeRead {
  std::uint64_t offset = 0;
  std::span<std::byte> out;
};

/// What is kept of a file that lies elsewhere.
struct RemoteCaches {
  /// In memory: the parts used last, at least 1 MiB of them. A round of reading takes up to 6 MiB
  /// besides.
  std::uint64_t memory_bytes = std::uint64_t{64} << 20;
  /// A folder in which what was read is kept for the next opening too; empty: none. A file in it has
  /// the name of the content, and so is never out of date.
  std::string folder;
};

/// One object, the same from its opening on: what is read of it is of that object, or an error.
/// Threads: read() may be called from several at once.
class RangeSource {
 public:
  RangeSource() = default;
  RangeSource(const RangeSource&) = delete;
  RangeSource& operator=(const RangeSource&) = delete;
  virtual ~RangeSource() = default;

  /// As it was named at its opening.
  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const noexcept = 0;
  /// The first bytes of the object, which came with its opening; may be empty. Cost of the opening:
  /// one request for these.
  [[nodiscard]] virtual std::span<const std::byte> front() const noexcept = 0;

  /// Reads all of these ranges, several at once: a *round*, for which a caller waits about as long as
  /// for one request. Ranges lie within the object.
  /// @throws Error io_error       the server refuses, fails again and again, or does not answer
  ///               corruption     the object is another one than at its opening, or was cut short
  ///               cancelled      a stop was requested
  virtual void read(std::span<const RangeRead> ranges) = 0;
};

}  // namespace ptin
