// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/source_lines.h"

#include <algorithm>

#include "engine/construct/read/line_file.h"
#include "engine/error.h"
#include "engine/memory_units.h"

namespace ptin {

namespace {

/// Counts the vertices of all files, and keeps them as long as they fit.
class LineKeeper {
 public:
  explicit LineKeeper(std::uint64_t most_bytes) : most_(most_bytes / kBytesOfLineVertex) {}

  void take(const std::vector<SourcePoint>& line, LineSet& to) {
    count_ += line.size();
    if (count_ <= most_) {
      to.vertices.insert(to.vertices.end(), line.begin(), line.end());
      to.ends.push_back(to.vertices.size());
    }
  }
  void require_room() const {
    if (count_ > most_) {
      const auto in_mib = [](std::uint64_t vertices) {
        return std::to_string(vertices * kBytesOfLineVertex / kMiB + 1) + "M";
      };
      throw Error(ErrorCode::resource_exhausted,
                  "breaklines and boundary have " + std::to_string(count_) +
                      " vertices, which take " + in_mib(count_) +
                      " of memory, and a quarter of --memory is theirs, " + in_mib(most_) +
                      "; give --memory " + in_mib(4 * count_) + ", or fewer lines");
    }
  }

 private:
  std::uint64_t most_, count_ = 0;
};

}  // namespace

SourceLines read_source_lines(const LineChoice& choice, std::uint64_t most_bytes,
                              const std::stop_token& stop) {
  SourceLines lines;
  LineKeeper keeper(most_bytes);
  const auto read = [&](const std::string& path, const LayerWish& wish, const TakeLine& take) {
    const LineFileCrs file = read_line_file(path, wish, take, stop);
    lines.files.push_back({path, file.crs, file.units});
    lines.warnings.join(file.warnings);
    return file.is_flat;
  };
  for (const std::string& path : choice.breaklines) {
    std::uint64_t flat = 0;
    read(path, {LayerKind::kLines, choice.breakline_layer, "--breakline-layer"},
         [&](const std::vector<SourcePoint>& line, bool has_heights) {
           flat += has_heights ? 0 : 1;
           keeper.take(line, has_heights ? lines.breaklines : lines.flat_breaklines);
         });
    if (flat > 0) {
      lines.warnings.add({.kind = "draped_breaklines",
                          .message =
                              "a breakline has no heights, and is laid on the surface of the "
                              "points; it divides triangles and tells no height of its own",
                          .file = path,
                          .count = flat});
    }
  }
  if (!choice.boundary.empty()) {
    lines.rings_are_flat =
        read(choice.boundary, {LayerKind::kAreas, choice.boundary_layer, "--boundary-layer"},
             [&](const std::vector<SourcePoint>& ring, bool) { keeper.take(ring, lines.rings); });
  }
  keeper.require_room();
  lines.most_vertices =
      std::min<std::uint64_t>(most_bytes / kBytesOfLineVertex, lines.most_vertices);
  return lines;
}

}  // namespace ptin
