// SPDX-License-Identifier: GPL-3.0-or-later
//
// Breaklines and the rings of a boundary, as their files give them, in memory.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// Lines one after the other, of one kind.
struct LineSet {
  std::vector<SourcePoint> vertices;
  std::vector<std::uint64_t> ends;  ///< One past the place of each line's last vertex.
  /// 0 for each of `vertices` that has no ground below, and whose z means nothing. Empty: all have
  /// ground.
  std::vector<std::uint8_t> has_ground;

  [[nodiscard]] std::size_t size() const noexcept { return ends.size(); }
  [[nodiscard]] std::span<const SourcePoint> line(std::size_t i) const noexcept {
    const std::uint64_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span(vertices).subspan(begin, ends[i] - begin);
  }
};

/// What one file of lines says of itself.
struct LineFileFacts {
  std::string path;
  std::string crs;      ///< As PointStreamFacts::crs.
  DeclaredUnits units;  ///< As PointStreamFacts::units.
};

/// All lines that a terrain is built with.
struct SourceLines {
  LineSet breaklines;
  LineSet flat_breaklines;  ///< Without heights: as rings that are flat.
  LineSet rings;            ///< The boundary; the first vertex of a ring is its last one too.
  /// The rings have no heights yet: they extend the grid, and nothing else is made of them
  /// (delaunay/line_drape.h).
  bool rings_are_flat = false;
  /// Lines without heights were laid on the surface, with all others, which agreed where they met.
  bool are_laid = false;
  std::vector<LineFileFacts> files;
  SourceWarnings warnings;                       ///< Warnings of all files.
  std::uint64_t most_vertices = UINT32_MAX - 1;  ///< The number that there is memory for.

  [[nodiscard]] bool is_empty() const noexcept {
    return breaklines.size() == 0 && flat_breaklines.size() == 0 && rings.size() == 0;
  }
  [[nodiscard]] bool want_ground() const noexcept {
    return rings_are_flat || flat_breaklines.size() > 0;
  }
};

/// Memory that a vertex of a line takes while a build holds it, at most: as it is read, and with the
/// edges, boxes and tables that are made of it.
inline constexpr std::uint64_t kBytesOfLineVertex = 320;

/// Reads the files of a choice.
/// @param most_bytes  For all lines; kBytesOfLineVertex a vertex.
/// @throws Error  not_found, io_error
///                invalid_argument    a file holds no lines (or areas)
///                resource_exhausted  more vertices than `most_bytes` hold; the message names them
///                cancelled
[[nodiscard]] SourceLines read_source_lines(
    const LineChoice& choice, std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max(),
    const std::stop_token& stop = {});

}  // namespace ptin
