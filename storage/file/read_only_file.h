// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file opened for reading, and whether it is still the file that was opened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <boost/interprocess/file_mapping.hpp>

#include "storage/file/announcer.h"
#include "storage/file/readable_file.h"
#include "storage/file/replaced_file.h"

namespace ptin {

/// A file opened for reading, closed when destroyed. Threads: const functions may be called at
/// once.
class ReadOnlyFile final : public ReadableFile {
 public:
  /// @param announcer  Hears what is read next; null: the kernel does.
  /// @throws Error not_found, io_error, invalid_argument (no regular file)
  explicit ReadOnlyFile(const std::string& path, std::shared_ptr<Announcer> announcer = nullptr,
                        ReplacedFile replaced = ReplacedFile::kRefused);

  [[nodiscard]] const std::string& path() const noexcept override { return path_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept override { return seen_.bytes; }
  [[nodiscard]] int descriptor() const noexcept;
  [[nodiscard]] const boost::interprocess::file_mapping& mapping() const noexcept { return file_; }

  /// Fills `out` from `offset` on.
  /// @throws Error io_error; corruption when the file ends before
  void read_at(std::span<std::byte> out, std::uint64_t offset) const override;

  /// Tells the kernel that reads will jump about: otherwise its read-ahead reads up to three times
  /// what a question about a point needs. A hint: never fails.
  void expect_jumps() const noexcept;
  /// Starts reading ranges. A hint: never fails.
  void will_need(std::span<const ByteRange> ranges) const noexcept override;

  /// Compares size, modification time and change time of the file with those at opening. A change
  /// that keeps all three is not seen, such as a write through a mapping that was made before. The
  /// change time, which a rename and new rights change as well, is not looked at where a file that
  /// was replaced answers on.
  /// @throws Error corruption  one of them differs; io_error
  void check_unchanged() const override;

 private:
  struct Seen {
    std::uint64_t bytes;
    std::int64_t modified_s, modified_ns, changed_s, changed_ns;
    friend bool operator==(const Seen&, const Seen&) = default;
  };
  [[nodiscard]] Seen look() const;
  void start_reading(const ByteRange& range) const noexcept;

  std::string path_;
  boost::interprocess::file_mapping file_;
  Seen seen_{};
  std::shared_ptr<Announcer> announcer_;
  ReplacedFile replaced_;
};

}  // namespace ptin
