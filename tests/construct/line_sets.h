// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines in memory, for tests: breaklines and rings in whole grid units.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/construct/lines/source_lines.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A vertex of a line of a test.
struct TestVertex {
  std::int64_t x, y, z;
};
using TestLine = std::vector<TestVertex>;

inline void add_line(LineSet& set, const TestLine& line) {
  for (const TestVertex& v : line) {
    set.vertices.push_back({{v.x, 0}, {v.y, 0}, {v.z, 0}});
  }
  set.ends.push_back(set.vertices.size());
}

inline SourceLines lines_of(const std::vector<TestLine>& breaklines,
                            const std::vector<TestLine>& rings = {}) {
  SourceLines lines;
  for (const TestLine& line : breaklines) {
    add_line(lines.breaklines, line);
  }
  for (const TestLine& ring : rings) {
    add_line(lines.rings, ring);
  }
  lines.files.push_back({"lines", "", {}});
  return lines;
}

}  // namespace ptin
