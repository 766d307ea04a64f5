// SPDX-License-Identifier: GPL-3.0-or-later
//
// Warnings of a reader of a source: the source declares or holds something that was probably meant
// otherwise than it is taken.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ptin {

/// One sentence, of one or many places.
struct SourceWarning {
  std::string kind;     ///< A name for programs, as "undeclared_nodata"; never changes.
  std::string message;  ///< The fact, how it is taken, and a way out; neither the file nor `count`.
  std::string file;     ///< The first that it is about; "" where it is about none.
  std::string subject{};       ///< A value or a name that tells warnings of a kind apart.
  std::uint64_t line = 0;      ///< The line of the first place, from 1; 0: none.
  std::uint64_t count = 0;     ///< Samples or points; 0 where it is about a file as a whole.
  std::uint64_t files = 1;     ///< Files that it is about.
  std::string last_file = {};  ///< The last of them; "" means `file`.
  std::uint64_t point = 0;     ///< The first point of `file` that it is about, from 1; 0: none.
};

/// Warnings in the order in which they were first given. Those of one kind and subject are one, with
/// the message of the first; so what is joined in the order of the source is the same whoever read
/// which part of it.
class SourceWarnings {
 public:
  /// Adds a warning that comes later in the source than all that are here.
  void add(SourceWarning warning);
  /// Adds those of the part of the source that comes next. A file of which both warn, the last
  /// one here, counts once.
  void join(const SourceWarnings& next);
  [[nodiscard]] const std::vector<SourceWarning>& all() const noexcept { return all_; }
  [[nodiscard]] bool is_empty() const noexcept { return all_.empty(); }

 private:
  std::vector<SourceWarning> all_;
};

}  // namespace ptin
