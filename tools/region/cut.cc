// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/region/cut_mesh.h"

namespace ptin::tools {

namespace {

using Ring = std::vector<BorderCorner>;

/// How far a polygon may reach, grid units: side() of spots is exact up to there.
constexpr double kFarthest = 0x1p38;
/// A side of a window outside of the terrain cuts nothing, wherever it is: it is moved to so many
/// grid units beside the terrain.
constexpr double kBeside = 16.0;

CutMesh cut_mesh_of(const Tin& tin, const StoreFacts& facts) {
  CutMesh mesh;
  mesh.nodes.resize(tin.vertices.size());
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const GridPoint p = tin.position(v);
    const MapPoint map = facts.map.to_map(p.x, p.y);
    CutNode& node = mesh.nodes[v];
    node.at = spot_of(p);
    node.has_height = tin.has_height[v] != 0;
    node.is_tin_vertex = true;
    node.map = {map.x, map.y, node.has_height ? facts.heights.height(tin.vertices[v].height) : 0.0};
  }
  mesh.triangles.resize(tin.triangles.size());
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& from = tin.triangles[t];
    mesh.triangles[t].v = {from.v[0], from.v[1], from.v[2]};
    mesh.triangles[t].n = {from.n[0], from.n[1], from.n[2]};
    mesh.triangles[t].cls = tin.classes[t];
    for (const VertexId v : from.v) mesh.nodes[v].triangle = t;
  }
  return mesh;
}

/// Corners that fall on one spot are one.
Ring without_repeats(Ring ring) {
  const auto is_one = [](const BorderCorner& a, const BorderCorner& b) { return a.at == b.at; };
  ring.erase(std::unique(ring.begin(), ring.end(), is_one), ring.end());
  while (ring.size() > 1 && is_one(ring.front(), ring.back())) ring.pop_back();
  return ring;
}

Ring ring_of(const Window& w, const SpotMap& spots, const StoreFacts& facts) {
  const GridBox& b = facts.bounds;
  Ring ring;
  for (const MapPoint corner : {MapPoint{w.min_x, w.min_y}, MapPoint{w.max_x, w.min_y},
                                MapPoint{w.max_x, w.max_y}, MapPoint{w.min_x, w.max_y}}) {
    const MapPoint grid = facts.map.to_grid(corner);
    ring.push_back({spots.rounded({std::clamp(grid.x, b.min_x - kBeside, b.max_x + kBeside),
                                   std::clamp(grid.y, b.min_y - kBeside, b.max_y + kBeside)}),
                    corner});
  }
  return without_repeats(std::move(ring));
}

Ring ring_of(const std::vector<MapPoint>& corners, const SpotMap& spots, const StoreFacts& facts) {
  Ring ring;
  for (const MapPoint corner : corners) {
    const MapPoint grid = facts.map.to_grid(corner);
    if (!(std::abs(grid.x) < kFarthest && std::abs(grid.y) < kFarthest)) {
      throw Error(ErrorCode::invalid_argument,
                  "the polygon reaches far beyond the terrain (2^38 grid units); give one near it");
    }
    ring.push_back({spots.rounded(grid), corner});
  }
  return without_repeats(std::move(ring));
}

std::vector<Ring> rings_of(const Region& region, const StoreFacts& facts) {
  const SpotMap spots(facts.map, facts.bounds);
  std::vector<Ring> rings;
  if (const auto* window = std::get_if<Window>(&region)) {
    rings.push_back(ring_of(*window, spots, facts));
  } else if (const auto* polygon = std::get_if<Polygon>(&region)) {
    for (const auto& corners : polygon->rings) rings.push_back(ring_of(corners, spots, facts));
  } else {
    throw Error(ErrorCode::invalid_argument,
                "only a window or a polygon can be cut to; a point has no inside");
  }
  return rings;
}

/// True when the segment may meet the box of the terrain; false is certain.
bool near_terrain(const BorderSegment& s, const GridBox& bounds) {
  const Spot a = s.from.at, b = s.to.at;
  const Spot low = spot_of(GridPoint{bounds.min_x, bounds.min_y});
  const Spot high = spot_of(GridPoint{bounds.max_x, bounds.max_y});
  return std::max(a.x, b.x) >= low.x && std::min(a.x, b.x) <= high.x &&
         std::max(a.y, b.y) >= low.y && std::min(a.y, b.y) <= high.y && line_meets(a, b, bounds);
}

void insert_ring(CutMesh& mesh, const Ring& ring, const GridBox& bounds) {
  const std::size_t n = ring.size();
  if (n < 2) return;
  std::vector<std::uint32_t> ids(n, kNone);
  for (std::size_t i = 0; i < n; ++i) {
    if (contains(bounds, ring[i].at)) ids[i] = mesh.insert_point(ring[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 == n ? 0 : i + 1;
    const BorderSegment segment{ring[i], ring[j]};
    if (ids[i] == kNone && ids[j] == kNone && !near_terrain(segment, bounds)) continue;
    mesh.insert_segment(segment, ids[i], ids[j]);
  }
}

/// Doubles are exact enough for the sides: what is asked of them lies in the middle of a triangle.
PolygonSides sides_on_grid(const std::vector<Ring>& rings) {
  std::vector<std::vector<MapPoint>> corners(rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i) {
    for (const BorderCorner& c : rings[i]) corners[i].push_back(grid_of(c.at));
  }
  return PolygonSides(corners);
}

/// Whether each triangle is inside of the region. All triangles of a piece of the mesh between
/// borders have one answer, which is asked at the middle of the largest of them.
std::vector<bool> inside_of(const CutMesh& mesh, const PolygonSides& sides) {
  std::vector<bool> inside(mesh.triangles.size(), false);
  std::vector<bool> seen(mesh.triangles.size(), false);
  std::vector<TriangleId> piece;
  for (TriangleId seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (seen[seed]) continue;
    piece.assign(1, seed);
    seen[seed] = true;
    TriangleId largest = seed;
    Int128 largest_area = -1;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const CutTriangle& t = mesh.triangles[piece[k]];
      const Int128 area = side(mesh.nodes[t.v[0]].at, mesh.nodes[t.v[1]].at, mesh.nodes[t.v[2]].at);
      if (area > largest_area) {
        largest_area = area;
        largest = piece[k];
      }
      for (std::size_t i = 0; i < 3; ++i) {
        if (t.border[i] || t.n[i] == kNone || seen[t.n[i]]) continue;
        seen[t.n[i]] = true;
        piece.push_back(t.n[i]);
      }
    }
    MapPoint middle;
    for (const auto v : mesh.triangles[largest].v) {
      const MapPoint corner = grid_of(mesh.nodes[v].at);
      middle = {middle.x + corner.x / 3, middle.y + corner.y / 3};
    }
    if (!sides.surround(middle)) continue;
    for (const TriangleId t : piece) inside[t] = true;
  }
  return inside;
}

}  // namespace

Mesh cut_to_region(const RefinedTin& refined, const StoreFacts& facts, const Region& region) {
  const std::vector<Ring> rings = rings_of(region, facts);
  CutMesh cut = cut_mesh_of(refined.tin, facts);
  Mesh mesh;
  if (cut.triangles.empty()) return mesh;
  for (const Ring& ring : rings) insert_ring(cut, ring, facts.bounds);
  const std::vector<bool> inside = inside_of(cut, sides_on_grid(rings));
  std::vector<std::uint32_t> place(cut.nodes.size(), kNone);
  for (TriangleId t = 0; t < cut.triangles.size(); ++t) {
    if (!inside[t] || cut.triangles[t].cls == TriangleClass::kVoid) continue;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = cut.triangles[t].v[i];
      if (place[v] == kNone) {
        place[v] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(cut.nodes[v].map);
      }
      corners[i] = place[v];
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

}  // namespace ptin::tools
