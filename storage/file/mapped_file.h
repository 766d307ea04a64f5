// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole file mapped for reading, under guard.
#pragma once

#include <cstddef>
#include <cstdint>

#include <boost/interprocess/mapped_region.hpp>

#include "storage/file/read_only_file.h"
#include "storage/file/sigbus_guard.h"

namespace ptin {

class MappedFile {
 public:
  /// Maps all of `file`, and tells the kernel that reads will jump about: its default read-ahead
  /// reads many times what a query wants.
  /// @throws Error io_error
  explicit MappedFile(const ReadOnlyFile& file);

  [[nodiscard]] const std::byte* at(std::uint64_t offset) const noexcept {
    return static_cast<const std::byte*>(region_.get_address()) + offset;
  }
  [[nodiscard]] bool is_damaged() const noexcept { return guard_.is_damaged(); }
  /// @throws Error corruption  a read met bytes that the file has lost
  ///                           (storage/file/sigbus_guard.h)
  void require_undamaged() const {
    if (is_damaged()) [[unlikely]] {
      report_damage();
    }
  }

 private:
  [[noreturn]] void report_damage() const;

  std::string path_;
  boost::interprocess::mapped_region region_;
  GuardedMapping guard_;
};

}  // namespace ptin
