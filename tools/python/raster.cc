// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at pixels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

#include "engine/crs/border_move.h"
#include "engine/error.h"
#include "tools/export/pixel_grid.h"
#include "tools/facts/source_count.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

using Pair = std::array<double, 2>;
using Counts = std::array<std::int64_t, 2>;

/// The window, or where none is given what the terrain covers: the box of its samples, of a raster
/// with half a pixel around it, as GDAL has it.
Window covered(const OpenTerrain& t, const std::optional<std::array<double, 4>>& window,
               const std::optional<MapPoint>& own) {
  if (window) return {(*window)[0], (*window)[1], (*window)[2], (*window)[3]};
  const StoreFacts& facts = t.terrain.store().facts();
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  const MapPoint half = own ? MapPoint{own->x / 2, own->y / 2} : MapPoint{};
  return {low.x - half.x, low.y - half.y, high.x + half.x, high.y + half.y};
}

/// So many columns and rows, whose areas fill the window.
RasterRequest pixels_that_fill(const Window& window, const Counts& size,
                               const std::optional<MapPoint>& own) {
  if (size[0] < 1 || size[1] < 1) refuse("a size is columns and rows, each at least 1", "size");
  if (!(window.min_x < window.max_x && window.min_y < window.max_y)) {
    refuse("the window is inverted or empty; its order is xmin ymin xmax ymax", "window");
  }
  RasterRequest request;
  PixelLattice& lattice = request.lattice;
  lattice.step_x = (window.max_x - window.min_x) / static_cast<double>(size[0]);
  lattice.step_y = -(window.max_y - window.min_y) / static_cast<double>(size[1]);
  lattice.origin = {window.min_x + lattice.step_x / 2, window.max_y + lattice.step_y / 2};
  // The frame of half a pixel around the samples of a raster belongs to them.
  if (own) lattice.margin = {own->x / 2, own->y / 2};
  request.pixels = {0, 0, size[0], size[1]};
  return request;
}

RasterRequest pixels_of(const OpenTerrain& t, const std::optional<std::array<double, 4>>& window,
                        const std::optional<Counts>& size, const std::optional<Pair>& pixel_size) {
  const std::optional<MapPoint> own = tools::own_pixel_of(t.terrain.store());
  if (size && pixel_size) refuse("a raster has a size or a pixel_size; leave one out");
  if (size) return pixels_that_fill(covered(t, window, own), *size, own);
  if (!pixel_size && !own) {
    refuse(
        "this terrain was not built from a raster, so it has no pixel size of its own; give size "
        "or pixel_size");
  }
  const Pair side = pixel_size ? *pixel_size : Pair{own->x, own->y};
  if (!(side[0] > 0 && side[1] > 0)) refuse("the sides of a pixel are above 0", "pixel_size");
  std::optional<Window> asked;
  if (window) asked = covered(t, window, own);
  return tools::pixels_in(asked, side, t.terrain.store().facts());
}

/// @throws Error resource_exhausted  the system has not so much memory, whatever the limit
py::array_t<double> new_array(const PixelRect& pixels) {
  try {
    return py::array_t<double>({pixels.height, pixels.width});
  } catch (const py::error_already_set& raised) {
    // NumPy says of what no address reaches that its shape is too big, by ValueError.
    if (!raised.matches(PyExc_MemoryError) && !raised.matches(PyExc_ValueError)) throw;
    throw Error(ErrorCode::resource_exhausted,
                "the system has no memory for an array of " + std::to_string(pixels.width) + " x " +
                    std::to_string(pixels.height) + " pixels: ask for fewer, or a smaller window",
                "size");
  }
}

py::tuple raster(const OpenTerrain& t, const std::optional<std::array<double, 4>>& window,
                 const std::optional<Counts>& size, const std::optional<Pair>& pixel_size,
                 bool as_fine_as_pixels, const Asked& asked) {
  std::stop_source stop;
  RasterRequest request = pixels_of(t, window, size, pixel_size);
  asked.put(request, stop.get_token());
  request.as_fine_as_pixels = as_fine_as_pixels;
  if (as_fine_as_pixels) {
    request.most_error =
        most_error_for_pixels(border_reach(t.terrain.store(), 1.0),
                              std::abs(request.lattice.step_x), std::abs(request.lattice.step_y));
  }
  const PixelRect& pixels = request.pixels;
  if (pixels.width > INT32_MAX || pixels.height > INT32_MAX) {
    refuse("the raster would have more than 2^31 - 1 columns or rows", "size");
  }
  constexpr std::uint64_t kMostPixels = UINT64_MAX / sizeof(double);
  const std::uint64_t bytes =
      std::min(static_cast<std::uint64_t>(pixels.pixels()), kMostPixels) * sizeof(double);
  std::uint64_t& memory = request.limits.memory_bytes;
  if (bytes > memory) {
    throw Error(ErrorCode::resource_exhausted,
                "the array alone takes " + std::to_string(bytes) +
                    " bytes, more than the limit of " + std::to_string(memory) +
                    ": ask for fewer pixels or a smaller window, or raise it",
                "size");
  }
  memory -= bytes;  // What the question may take beside it.
  py::array_t<double> heights = new_array(pixels);
  const std::span<double> places(heights.mutable_data(), static_cast<std::size_t>(pixels.pixels()));
  const RasterResult found = answer(t, stop, [&] { return t.terrain.raster(request, places); });
  const std::array<double, 6> g = tools::geotransform_of(request);
  return py::make_tuple(heights, py::make_tuple(g[1], g[2], g[0], g[4], g[5], g[3]),
                        certificate_of(found));
}

}  // namespace

void add_rasters(py::module_& module) { module.def("raster", raster); }

}  // namespace ptin::python
