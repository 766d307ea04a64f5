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
  const auto read = [&](const std::string& path, const LineWish& wish, LineSet& to) {
    const LineFileCrs file = read_line_file(
        path, wish, [&](const std::vector<SourcePoint>& line) { keeper.take(line, to); }, stop);
    lines.files.push_back({path, file.crs, file.units});
    lines.warnings.join(file.warnings);
    lines.rings_are_flat = lines.rings_are_flat || file.is_flat;
  };
  for (const std::string& path : choice.breaklines) {
    read(path, {LayerKind::kLines, choice.breakline_layer, "--breakline-layer"}, lines.breaklines);
  }
  if (!choice.boundary.empty()) {
    read(choice.boundary, {LayerKind::kAreas, choice.boundary_layer, "--boundary-layer"},
         lines.rings);
  }
  keeper.require_room();
  lines.most_vertices =
      std::min<std::uint64_t>(most_bytes / kBytesOfLineVertex, lines.most_vertices);
  return lines;
}

}  // namespace ptin
