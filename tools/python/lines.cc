// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines, as GeoArrow lays lines out: coordinates, and where each line begins.
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// The levels of an interval over the heights of a terrain; where it has none there, one that no
/// line is on.
std::vector<double> levels_every(double interval, double base, const StoreFacts& facts) {
  std::vector<double> levels = levels_at(interval, base, facts.min_height, facts.max_height);
  if (levels.empty()) levels.push_back(std::max(facts.max_height, base) + interval);
  return levels;
}

struct LineArrays {
  std::vector<double> coordinates, level;
  std::vector<std::int64_t> offsets{0};
  std::vector<std::uint8_t> ring;

  explicit LineArrays(const Isolines& lines) {
    coordinates.reserve(2 * lines.points());
    std::vector<MapPoint> points;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Isoline line = lines.line(i, points);
      for (const MapPoint& p : line.points) coordinates.insert(coordinates.end(), {p.x, p.y});
      offsets.push_back(static_cast<std::int64_t>(coordinates.size() / 2));
      level.push_back(lines.levels()[line.level]);
      ring.push_back(line.ring ? 1 : 0);
    }
  }
};

py::tuple isolines(const OpenTerrain& t, const std::vector<double>& levels,
                   std::optional<double> interval, double base, const RegionArgument& region,
                   const Asked& asked) {
  std::stop_source stop;
  IsolineRequest request;
  asked.put(request, stop.get_token());
  request.levels = interval ? levels_every(*interval, base, t.terrain.store().facts()) : levels;
  request.region = region_of(region);
  std::error_code missing;  // without a folder no file is made: points are to fit into memory
  request.temporary_folder = std::filesystem::temp_directory_path(missing).string();
  std::optional<LineArrays> arrays;
  const py::tuple certificate = certificate_of(answer(t, stop, [&] {
    const Isolines lines = t.terrain.isolines(request);
    arrays.emplace(lines);
    struct Certified {
      double certified_error, certified_deviation;
      bool exact;
    };
    return Certified{lines.certified_error, lines.certified_deviation, lines.exact};
  }));
  return py::make_tuple(table_of(std::move(arrays->coordinates), 2),
                        array_of(std::move(arrays->offsets)), array_of(std::move(arrays->level)),
                        array_of(std::move(arrays->ring)), certificate);
}

}  // namespace

void add_lines(py::module_& module) { module.def("isolines", isolines); }

}  // namespace ptin::python
