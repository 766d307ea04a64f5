// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/delaunay.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include "engine/error.h"

namespace ptin {
namespace {

// Grid coordinates are below 2^53, so doubles hold them exactly, and the kernel's predicates are
// exact.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexId, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<TriangleId, Kernel>;
using DataStructure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, DataStructure>;

[[noreturn]] void refuse(const char* sentence) {
  throw Error(ErrorCode::invalid_argument, sentence);
}

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
  static constexpr std::size_t kBetweenStops = 4096;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % kBetweenStops == 0 && stop.stop_requested()) {
      throw Error(ErrorCode::cancelled, "the triangulation was cancelled");
    }
    const Delaunay::Vertex_handle v = delaunay.insert(points[order[i]], hint);
    v->info() = static_cast<VertexId>(order[i]);
    hint = v->face();
  }
  return delaunay;
}

/// A face and where its smallest vertex id stands in it.
struct Oriented {
  Delaunay::Face_handle face;
  int first = 0;

  [[nodiscard]] VertexId corner(int i) const {
    return face->vertex(first + i > 2 ? first + i - 3 : first + i)->info();
  }
  [[nodiscard]] TriangleId neighbour(int i) const {
    return face->neighbor(first + i > 2 ? first + i - 3 : first + i)->info();
  }
};

/// The finite faces in ascending order of their first two corners, numbered; infinite ones get
/// kNone.
std::vector<Oriented> number_faces(const Delaunay& delaunay, std::size_t vertices) {
  std::vector<Oriented> faces;
  faces.reserve(2 * vertices);
  std::vector<std::uint32_t> start(vertices + 1, 0);
  for (auto f = delaunay.all_faces_begin(); f != delaunay.all_faces_end(); ++f) {
    f->info() = kNone;
    if (delaunay.is_infinite(f)) {
      continue;
    }
    Oriented face{f, 0};
    for (int i : {1, 2}) {
      if (f->vertex(i)->info() < face.corner(0)) {
        face.first = i;
      }
    }
    ++start[face.corner(0) + 1];
    faces.push_back(face);
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Oriented> sorted(faces.size());
  auto next = start;
  for (const Oriented& face : faces) {
    sorted[next[face.corner(0)]++] = face;
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    std::sort(sorted.begin() + start[v], sorted.begin() + start[v + 1],
              [](const Oriented& a, const Oriented& b) { return a.corner(1) < b.corner(1); });
  }
  for (std::size_t t = 0; t < sorted.size(); ++t) {
    sorted[t].face->info() = static_cast<TriangleId>(t);
  }
  return sorted;
}

/// Gives each vertex a triangle: on the border the one without a clockwise neighbour, inside the
/// first.
void link_vertices(Tin& tin) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      TriangleId& of_vertex = tin.vertices[tin.triangles[t].v[i]].triangle;
      if (of_vertex == kNone || tin.triangles[t].n[previous_corner(i)] == kNone) {
        of_vertex = t;
      }
    }
  }
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
  const std::vector<Oriented> faces = number_faces(delaunay, positions.size());
  tin.triangles.reserve(faces.size());
  for (const Oriented& f : faces) {
    tin.triangles.push_back({{f.corner(0), f.corner(1), f.corner(2)},
                             {f.neighbour(0), f.neighbour(1), f.neighbour(2)}});
  }
  tin.classes.assign(faces.size(), TriangleClass::kSurface);
  link_vertices(tin);
  return tin;
}

}  // namespace ptin
