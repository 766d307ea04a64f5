// SPDX-License-Identifier: GPL-3.0-or-later
//
// Opening a terrain, and what is known of it without a question.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/crs/border_move.h"
#include "engine/crs/ground.h"
#include "engine/remote/remote_file.h"
#include "tools/facts/source_count.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// Opens a file or an object elsewhere. Pages are read and not mapped: a file that is cut short is
/// an error then and no signal, which a library may not take.
/// @param timeout  Seconds in which a silent server is given up, about; none: as RemoteOptions.
std::shared_ptr<OpenTerrain> open(const std::string& name, std::optional<double> timeout) {
  std::stop_source waiting;
  return run_interruptibly(waiting, [&] {
    const bool is_elsewhere = is_remote(name);
    RemoteOptions options;
    options.stop = waiting.get_token();
    if (timeout) {
      // Each try may be silent for its share; curl takes whole seconds. The pauses between tries, each
      // twice as long as the one before, are a quarter of that together.
      const long share = std::max(1L, std::lround(*timeout / options.tries));
      options.most_seconds_to_connect = options.most_silent_seconds = share;
      options.first_pause = std::min(options.first_pause, *timeout / 60);
    }
    Terrain terrain = is_elsewhere
                          ? Terrain(open_remote_store(name, options))
                          : Terrain::open(name, PageAccess::kPread, ReplacedFile::kAnswers);
    CrsFacts crs = crs_facts(terrain.store());
    return std::make_shared<OpenTerrain>(
        OpenTerrain{std::move(terrain), std::move(crs), is_elsewhere, waiting});
  });
}

py::tuple bounds_of(const OpenTerrain& t) {
  const StoreFacts& facts = t.terrain.store().facts();
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  return py::make_tuple(low.x, low.y, high.x, high.y);
}

py::object pixel_size_of(const OpenTerrain& t) {
  const std::optional<MapPoint> own = tools::own_pixel_of(t.terrain.store());
  if (!own) return py::none();
  return py::make_tuple(own->x, own->y);
}

py::object height_range_of(const OpenTerrain& t) {
  const StoreFacts& facts = t.terrain.store().facts();
  if (facts.min_height > facts.max_height) return py::none();
  return py::make_tuple(facts.min_height, facts.max_height);
}

/// Rows (error, vertices), from the coarsest on: the upper ends of the bins of the table of errors, and
/// how many vertices the TIN within such an error has.
py::array_t<double> errors_of(const OpenTerrain& t) {
  const StoreFile& store = t.terrain.store();
  const std::span<const ErrorBin> bins = store.error_bins();
  std::uint64_t vertices = store.t0().vertices.size();
  std::vector<double> rows;
  for (std::size_t i = bins.size(); i-- > 0;) {
    if (bins[i].records == 0) continue;
    rows.insert(rows.end(), {static_cast<double>(bins[i].upper), static_cast<double>(vertices)});
    vertices += bins[i].records;
  }
  return table_of(std::move(rows), 2);
}

py::dict units_of(const OpenTerrain& t) {
  py::dict units;
  units["horizontal"] = t.crs.horizontal_unit;
  units["height"] = t.crs.vertical_unit;
  units["length"] = t.crs.geographic ? std::string("metre") : t.crs.horizontal_unit;
  units["ground"] = unit_of_ground(t.crs);
  return units;
}

}  // namespace

void add_terrain(py::module_& module) {
  py::class_<OpenTerrain, std::shared_ptr<OpenTerrain>>(module, "Terrain")
      .def_property_readonly("is_stopped",
                             [](const OpenTerrain& t) { return t.waiting.stop_requested(); })
      .def("stop_waiting", [](const OpenTerrain& t) { t.stop_waiting(); })
      .def_property_readonly("bounds", bounds_of)
      .def_property_readonly("pixel_size", pixel_size_of)
      .def_property_readonly("height_range", height_range_of)
      .def_property_readonly("errors", errors_of)
      .def_property_readonly("units", units_of)
      .def_property_readonly("crs", [](const OpenTerrain& t) { return t.crs.horizontal_text(); })
      .def_property_readonly("vertical_crs",
                             [](const OpenTerrain& t) { return t.crs.vertical_text(); })
      .def_property_readonly("wkt", [](const OpenTerrain& t) { return t.crs.wkt; })
      .def_property_readonly(
          "samples", [](const OpenTerrain& t) { return t.terrain.store().facts().source_samples; })
      .def_property_readonly("vertices",
                             [](const OpenTerrain& t) {
                               const StoreFile& store = t.terrain.store();
                               return store.t0().vertices.size() + store.record_count();
                             })
      .def_property_readonly(
          "base_error", [](const OpenTerrain& t) { return t.terrain.store().facts().base_error; })
      .def("border_moved_at_most", [](const OpenTerrain& t, double error) {
        return border_moved_at_most(t.terrain.store(), error);
      });
  module.def("open", open);
  // The child of a fork holds what its parent uses on: to close it would end the parent's connections.
  module.def("never_close", [](py::object terrain) { terrain.release(); });
}

}  // namespace ptin::python
