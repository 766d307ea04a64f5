// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a reader of a source warns of: what the source declares or holds that was probably meant
// otherwise than it is taken.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ptin {

/// One sentence, of one or many places.
struct SourceWarning {
  std::string kind;  ///< A name for programs, as "undeclared_nodata"; never changes.
  std::string
      message;       ///< What is taken how, and a way out. It names neither the file nor `count`.
  std::string file;  ///< The first that it is about; "" where it is about none.
  std::string subject{};    ///< What tells warnings of a kind apart, as a value or a name.
  std::uint64_t line = 0;   ///< Of the first place, from 1; 0 where it has none.
  std::uint64_t count = 0;  ///< How many samples or points; 0 where it is about a file as a whole.
  std::uint64_t files = 1;  ///< How many files it is about.
  std::string last_file = {};  ///< The last of them; "" means `file`.
};

/// Warnings in the order in which they were first given. Those of one kind and subject are one, with
/// the message of the first; so what is joined in the order of the source is the same whoever read
/// which part of it.
class SourceWarnings {
 public:
  /// Adds a warning that comes later in the source than all that are here.
  void add(SourceWarning warning);
  /// Adds those of the part of the source that comes next. What both say of the same file, the last
  /// one here, counts that file once.
  void join(const SourceWarnings& next);
  [[nodiscard]] const std::vector<SourceWarning>& all() const noexcept { return all_; }
  [[nodiscard]] bool is_empty() const noexcept { return all_.empty(); }

 private:
  std::vector<SourceWarning> all_;
};

}  // namespace ptin
