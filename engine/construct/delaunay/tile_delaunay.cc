// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/delaunay/tile_delaunay.h"

#include <algorithm>
#include <utility>

#include "engine/construct/delaunay/growing_delaunay.h"
#include "engine/error.h"

namespace ptin {

namespace {

using delaunay_internal::add_faces;
using delaunay_internal::Face_handle;
using delaunay_internal::GrowingDelaunay;
using delaunay_internal::number_faces;
using delaunay_internal::Oriented;
using delaunay_internal::position_of;
using delaunay_internal::Triangulation;
using delaunay_internal::Vertex_handle;

/// Finds the triangles that have an edge that is too long. The answer for an edge is the same in
/// every tile.
struct LongestEdge {
  double length;  ///< On the ground.
  const GroundMetric& ground;

  [[nodiscard]] bool is_within(GridPoint a, GridPoint b) const noexcept {
    const GroundStep step = ground.at((static_cast<double>(a.y) + b.y) / 2.0);
    const double dx = (static_cast<double>(a.x) - b.x) * step.x;
    const double dy = (static_cast<double>(a.y) - b.y) * step.y;
    // Decimal steps are rounded to binary: an edge of just this length is not longer.
    constexpr double kJust = 1.0 + 1e-12;
    return dx * dx + dy * dy <= length * length * kJust;
  }
  [[nodiscard]] bool is_within(GridPoint a, GridPoint b, GridPoint c) const noexcept {
    return is_within(a, b) && is_within(b, c) && is_within(c, a);
  }
};

/// Finds the triangles that are surface: those within the boundary, without an edge that is too
/// long.
struct SurfaceRule {
  std::optional<LongestEdge> longest;
  const FixedEdges& fixed;

  [[nodiscard]] bool has_voids() const noexcept { return longest || fixed.has_boundary(); }
  [[nodiscard]] bool is_surface(GridPoint a, GridPoint b, GridPoint c) const {
    return (!longest || longest->is_within(a, b, c)) && fixed.holds(a, b, c);
  }
  [[nodiscard]] bool is_surface(const Face_handle& f) const {
    return is_surface(position_of(f->vertex(0)), position_of(f->vertex(1)),
                      position_of(f->vertex(2)));
  }
};

/// The finite faces whose smallest vertex is one of the tile's own.
std::vector<Face_handle> own_faces(GrowingDelaunay& grown) {
  Triangulation& delaunay = grown.delaunay();
  std::vector<Face_handle> faces;
  faces.reserve(2 * grown.own_points());
  for (auto f = delaunay.all_faces_begin(); f != delaunay.all_faces_end(); ++f) {
    f->info() = kNone;
    if (delaunay.is_infinite(f)) {
      continue;
    }
    int smallest = 0;
    for (const int i : {1, 2}) {
      if (key_of(position_of(f->vertex(i))) < key_of(position_of(f->vertex(smallest)))) {
        smallest = i;
      }
    }
    if (grown.is_own(f->vertex(smallest)->info())) {
      faces.push_back(f);
    }
  }
  return faces;
}

/// Numbers the vertices of the faces by key, and makes the tile.
DelaunayTile cut_out(const GrowingDelaunay& grown, const std::vector<Face_handle>& faces) {
  DelaunayTile tile;
  tile.own_points = grown.own_points();
  tile.other_points = grown.points() - tile.own_points;
  std::vector<std::uint8_t> used(grown.points(), 0);
  for (const Face_handle& f : faces) {
    for (int i = 0; i < 3; ++i) {
      used[f->vertex(i)->info()] = 1;
    }
  }
  std::vector<std::pair<VertexKey, VertexId>> order;
  order.reserve(grown.points());
  for (VertexId v = 0; v < grown.points(); ++v) {
    if (used[v] != 0) {
      order.emplace_back(key_of(position_of(grown.handle(v))), v);
    }
  }
  std::sort(order.begin(), order.end());
  Tin& tin = tile.tin;
  tin.vertices.reserve(order.size());
  for (const auto& [key, v] : order) {
    grown.handle(v)->info() = static_cast<VertexId>(tin.vertices.size());
    tin.vertices.push_back({point_of(key), grown.height(v), kNone});
  }
  tin.has_height.assign(order.size(), 1);
  const std::vector<Oriented> numbered = number_faces(faces, order.size());
  add_faces(numbered, tin);
  if (grown.has_fixed_edges()) {
    for (const Oriented& f : numbered) {
      tile.fixed_sides.push_back(static_cast<std::uint8_t>(
          (f.is_fixed(0) ? 1 : 0) | (f.is_fixed(1) ? 2 : 0) | (f.is_fixed(2) ? 4 : 0)));
    }
  }
  return tile;
}

/// The corners of faces that are not own points of the tile.
std::vector<VertexId> other_corners(const GrowingDelaunay& grown,
                                    const std::vector<Face_handle>& faces) {
  std::vector<std::uint8_t> marked(grown.points(), 0);
  std::vector<VertexId> corners;
  for (const Face_handle& f : faces) {
    for (int i = 0; i < 3; ++i) {
      const VertexId v = f->vertex(i)->info();
      if (!grown.is_own(v) && marked[v] == 0) {
        marked[v] = 1;
        corners.push_back(v);
      }
    }
  }
  return corners;
}

/// Makes triangles void that are no surface. Vertices with void triangles alone lose their height,
/// and are counted as lone where they are own points.
void make_voids(const GrowingDelaunay& grown, const SurfaceRule& rule, DelaunayTile& tile) {
  Tin& tin = tile.tin;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t].v;
    if (!rule.is_surface(tin.position(v[0]), tin.position(v[1]), tin.position(v[2]))) {
      tin.classes[t] = TriangleClass::kVoid;
    }
  }
  for (VertexId id = 0; id < grown.points(); ++id) {
    const Vertex_handle handle = grown.handle(id);
    const VertexId v = handle->info();
    if (v >= tin.vertices.size() || tin.position(v) != position_of(handle)) {
      continue;  // no vertex of the tile
    }
    auto f = grown.delaunay().incident_faces(handle);
    const auto first = f;
    bool surface = false;
    do {
      surface = surface || (!grown.delaunay().is_infinite(f) && rule.is_surface(f));
    } while (++f != first);
    tin.has_height[v] = surface ? 1 : 0;
    tile.lone_points += !surface && grown.is_own(id) ? 1 : 0;
  }
}

}  // namespace

DelaunayTiler::DelaunayTiler(const PointBuckets& buckets, std::optional<double> longest_edge,
                             std::size_t cache_bytes)
    : buckets_(buckets),
      longest_edge_(longest_edge),
      ground_(buckets.frame()),
      cache_bytes_(cache_bytes) {}

DelaunayTile DelaunayTiler::make(std::uint64_t first, std::uint64_t count,
                                 const std::stop_token& stop) {
  if (count > kNone / 8) {
    throw Error(ErrorCode::resource_exhausted, "more points than one mesh in memory counts");
  }
  GrowingDelaunay grown(buckets_, first, count, cache_bytes_, stop);
  grown.triangulate();
  if (!grown.holds_everything()) {
    grown.settle(grown.own_vertices_to_settle());
  }
  const std::vector<Face_handle> faces = own_faces(grown);
  SurfaceRule rule{{}, buckets_.fixed_edges()};
  if (longest_edge_) {
    rule.longest.emplace(LongestEdge{*longest_edge_, ground_});
  }
  if (!rule.has_voids()) {
    return cut_out(grown, faces);
  }
  // Whether a vertex has a surface at all depends on all triangles around it.
  if (!grown.holds_everything()) {
    grown.settle(other_corners(grown, faces));
  }
  DelaunayTile tile = cut_out(grown, own_faces(grown));
  make_voids(grown, rule, tile);
  return tile;
}

}  // namespace ptin
