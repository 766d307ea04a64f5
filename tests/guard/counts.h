// SPDX-License-Identifier: GPL-3.0-or-later
//
// Counts that no machine changes, and the table that they are held against.
#pragma once

#include <string>
#include <vector>

namespace ptin::guard {

/// Less is better.
struct Count {
  std::string terrain;
  std::string what;
  double value = 0.0;
  bool operator==(const Count&) const = default;
};
using Counts = std::vector<Count>;

/// Builds the terrain of tests/data and asks it: bytes a vertex; pages, stars and nodes of points;
/// records a vertex of windows; nodes of searches; vertices at tolerances; bytes of a stream. Places
/// are seeded.
[[nodiscard]] Counts counts_of(const std::string& terrain);

/// The table: a header, then a line a count. @throws std::runtime_error  it is not there, or a line
/// is no count
[[nodiscard]] Counts read_table(const std::string& path);
void write_table(const std::string& path, const Counts& counts);

/// What makes `now` worse than the table, a sentence each: a count that is larger by more than
/// `tolerance` (a share of it), and rows that only one of the two has.
[[nodiscard]] std::vector<std::string> what_is_worse(const Counts& table, const Counts& now,
                                                     double tolerance);

}  // namespace ptin::guard
