// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/delaunay_tin.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include "engine/construct/delaunay/delaunay_kernel.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {
namespace {

using namespace delaunay_internal;
using Kernel = GridKernel;

void check(std::span<const GridPoint> positions, std::span<const HeightBits> heights) {
  if (positions.size() != heights.size()) {
    refuse("a triangulation needs one height for each point");
  }
  if (positions.size() < 3) {
    refuse("fewer than 3 distinct points: they span no triangle");
  }
  if (positions.size() > kNone / 2) {
    throw Error(ErrorCode::resource_exhausted, "more points than one mesh in memory counts");
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!on_grid(positions[i])) {
      refuse("a point lies outside of the grid");
    }
    if (i > 0 && key_of(positions[i - 1]) >= key_of(positions[i])) {
      refuse("points to be triangulated must be sorted by y, then x, without duplicates");
    }
  }
}

/// Inserts the points along a space-filling curve, which makes each next to the one before.
Delaunay triangulate(std::span<const GridPoint> positions, const std::stop_token& stop) {
  std::vector<Kernel::Point_2> points;
  points.reserve(positions.size());
  for (const GridPoint p : positions) {
    points.emplace_back(p.x, p.y);
  }
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  using Map = CGAL::Pointer_property_map<Kernel::Point_2>::const_type;
  CGAL::spatial_sort(order.begin(), order.end(),
                     CGAL::Spatial_sort_traits_adapter_2<Kernel, Map>(
                         CGAL::make_property_map(std::as_const(points))));
  Delaunay delaunay;
  Delaunay::Face_handle hint;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % kStopInterval == 0) {
      stop_if_asked(stop, "the triangulation");
    }
    const Delaunay::Vertex_handle v = delaunay.insert(points[order[i]], hint);
    v->info() = static_cast<VertexId>(order[i]);
    hint = v->face();
  }
  return delaunay;
}

}  // namespace

Tin make_delaunay_tin(std::span<const GridPoint> positions, std::span<const HeightBits> heights,
                      const std::stop_token& stop) {
  check(positions, heights);
  const Delaunay delaunay = triangulate(positions, stop);
  if (delaunay.dimension() < 2) {
    refuse("all points are collinear: they span no triangle");
  }
  Tin tin;
  tin.vertices.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    tin.vertices.push_back({positions[i], heights[i], kNone});
  }
  tin.has_height.assign(positions.size(), 1);
  std::vector<Delaunay::Face_handle> faces;
  faces.reserve(delaunay.number_of_faces());
  for (auto f = delaunay.all_faces_begin(); f != delaunay.all_faces_end(); ++f) {
    f->info() = kNone;
    if (!delaunay.is_infinite(f)) {
      faces.push_back(f);
    }
  }
  add_faces(number_faces(faces, positions.size()), tin);
  return tin;
}

}  // namespace ptin
