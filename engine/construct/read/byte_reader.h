// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file read forwards: as lines, as blocks of bytes, or as whatever comes next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/handle.h"

namespace ptin {

/// Reads forwards through one buffer of 256 KiB. Lines and spans that it returns point into the
/// buffer, and are valid until the next call. Not thread-safe.
class ByteReader {
 public:
  /// @throws Error not_found, io_error
  explicit ByteReader(std::string path);
  /// Reads `content`, which it keeps, instead of a file; `name` stands for the path in errors.
  ByteReader(std::string name, std::string content);

  /// The next line without its end (LF, CR LF, a CR alone); false at the end of the file. A byte
  /// order mark of UTF-8 is no part of the first line.
  /// @throws Error invalid_argument  longer than 64 KiB; the file is UTF-16 or UTF-32; io_error
  [[nodiscard]] bool line(std::string_view& text);
  /// The line that was handed out last ended in a CR alone.
  [[nodiscard]] bool ended_in_cr() const noexcept { return ended_in_cr_; }
  /// From here on a line ends behind a CR, whatever follows. To be called where other bytes than
  /// text may follow the last line: the first of them may be an LF by chance.
  void end_lines_in_cr() noexcept { only_cr_ = true; }
  /// The next `count` bytes, at most 64 KiB; fewer at the end of the file.  @throws Error io_error
  [[nodiscard]] std::span<const char> bytes(std::size_t count);
  /// Some further bytes, at most 64 KiB; none at the end of the file.  @throws Error io_error
  [[nodiscard]] std::span<const char> some() { return bytes(kLongest); }

  static constexpr std::size_t kLongest = std::size_t{64} << 10;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }  ///< Bytes of the whole file.
  /// Bytes handed out so far.
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  /// "path:line" of the last line handed out, for errors.
  [[nodiscard]] std::string place() const { return path_ + ":" + std::to_string(line_); }

 private:
  /// Makes at least `count` bytes available where the file has them.
  void want(std::size_t count);
  void take(std::size_t count) noexcept {
    begin_ += count;
    position_ += count;
  }

  std::string path_;
  Handle<std::FILE, &std::fclose> file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< The bytes of buffer_ still to be handed out.
  std::uint64_t size_ = 0, position_ = 0, line_ = 0;
  bool ended_in_cr_ = false, only_cr_ = false;
};

/// @throws Error invalid_argument  at the place that `in` has reached; always
[[noreturn]] void refuse_at(const ByteReader& in, const std::string& sentence);

}  // namespace ptin
