// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the parts of the module share: how arrays and regions come from Python and results go there.
// The functions that they declare take and give plain values; what people see is Python (ptin/).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/python/interruptible.h"

namespace ptin::python {

namespace py = pybind11;

/// A terrain with what is looked up once. Threads: const functions may be called at once.
struct OpenTerrain {
  Terrain terrain;
  CrsFacts crs;
  bool is_remote = false;
  /// Ends waiting for the server, for all questions and for good: what is asked next opens the terrain
  /// anew.
  mutable std::stop_source waiting{};

  /// What a stop of a question of this terrain calls.
  void stop_waiting() const noexcept {
    if (is_remote) waiting.request_stop();
  }
};

/// Runs a question of a terrain as run_interruptibly() does; a signal also ends waiting for its server.
template <typename Work>
auto answer(const OpenTerrain& t, std::stop_source& stop, const Work& work) {
  const std::stop_callback on_stop(stop.get_token(), [&t] { t.stop_waiting(); });
  return run_interruptibly(stop, work);
}

/// Positions: an (N, 2) array of float64 is a span of MapPoint, so it is not copied.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
static_assert(sizeof(MapPoint) == 2 * sizeof(double));

/// A window, or the rings of a polygon.
using RegionArgument = std::optional<std::variant<std::array<double, 4>, std::vector<Numbers>>>;

/// How finely and with how much memory a question is asked.
struct Asked {
  std::optional<double> error;
  std::optional<std::uint64_t> vertices;
  std::optional<std::uint64_t> memory;  ///< Bytes; none: what the request has.

  template <typename Request>
  void put(Request& request, const std::stop_token& stop) const {
    request.detail = {error, vertices};
    if (memory) request.limits.memory_bytes = *memory;
    request.limits.stop = stop;
  }
};

/// @throws Error invalid_argument  the shape is neither (N, 2) nor (2,)
[[nodiscard]] std::span<const MapPoint> points_of(const Numbers& xy);
[[nodiscard]] std::optional<Region> region_of(const RegionArgument& argument);

/// An array that owns the memory of `values`: no copy. REQUIRES: the GIL.
template <typename T>
[[nodiscard]] py::array_t<T> array_of(std::vector<T>&& values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  kept.release();
  return py::array_t<T>(std::move(shape), data, owner);
}
template <typename T>
[[nodiscard]] py::array_t<T> array_of(std::vector<T>&& values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return array_of(std::move(values), {size});
}
/// Rows of `columns` values.
template <typename T>
[[nodiscard]] py::array_t<T> table_of(std::vector<T>&& values, py::ssize_t columns) {
  const auto rows = static_cast<py::ssize_t>(values.size()) / columns;
  return array_of(std::move(values), {rows, columns});
}

/// The three numbers that every answer ends with: error, deviation, whether it is exact.
template <typename Result>
[[nodiscard]] py::tuple certificate_of(const Result& result) {
  return py::make_tuple(result.certified_error, result.certified_deviation, result.exact);
}

/// "surface", "void", "outside", as in JSON.
[[nodiscard]] const char* name_of(PointState state) noexcept;

/// A sentence with options as arguments of Python: "--max-edge" is max_edge.
[[nodiscard]] std::string without_dashes(const std::string& sentence);

// Each adds its functions and classes to the module.
void add_errors(py::module_& module);
void add_questions(py::module_& module);
void add_terrain(py::module_& module);
void add_places(py::module_& module);
void add_heights(py::module_& module);
void add_meshes(py::module_& module);
void add_rasters(py::module_& module);
void add_lines(py::module_& module);
void add_sight(py::module_& module);
void add_volumes(py::module_& module);
void add_build(py::module_& module);

}  // namespace ptin::python
