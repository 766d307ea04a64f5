// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a store reads from: a file of the system's (read_only_file.h), or one that lies elsewhere
// (ranged_file.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "storage/file/io_counters.h"
#include "storage/file/range_source.h"

namespace ptin {

/// When announced ranges are wanted: one after the other, or with whatever is read next.
enum class Coming { kInOrder, kWithNext };

/// A file that is read at any place. Threads: const functions may be called at once.
class ReadableFile {
 public:
  ReadableFile() = default;
  ReadableFile(const ReadableFile&) = delete;
  ReadableFile& operator=(const ReadableFile&) = delete;
  virtual ~ReadableFile() = default;

  [[nodiscard]] virtual const std::string& path() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const noexcept = 0;

  /// Fills `out` from `offset` on.
  /// @throws Error io_error; corruption when the file ends before, or is another one than at its
  ///               opening
  virtual void read_at(std::span<std::byte> out, std::uint64_t offset) const = 0;

  /// Announces that these ranges are read next, by this thread, in this order. A hint: never fails.
  virtual void will_need(std::span<const ByteRange> ranges) const noexcept = 0;
  /// Announces ranges that go with what this thread reads next, whatever that is. A hint: never fails.
  virtual void will_also_need(std::span<const ByteRange> ranges) const noexcept {
    will_need(ranges);
  }

  /// True for files elsewhere, where one read that was not announced costs as much time as a whole
  /// announced batch: reading what will probably be wanted along with what is wanted pays there.
  [[nodiscard]] virtual bool is_far() const noexcept { return false; }
  /// Whether a range is read without waiting for the server of a file that is far.
  [[nodiscard]] virtual bool is_at_hand(const ByteRange& /*range*/) const noexcept { return true; }
  /// Adds what this thread's reads cost the server since this was last called.
  virtual void settle(IoCounters& /*counters*/) const noexcept {}

  /// @throws Error corruption  the file is another one than at its opening, as far as can be seen
  ///                           without reading; io_error
  virtual void check_unchanged() const = 0;
};

}  // namespace ptin
