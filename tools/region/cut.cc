// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/cut.h"

#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "tools/region/cut_mesh.h"

namespace ptin::tools {

namespace {

struct Ring {
  std::vector<LatticePoint> lattice;
  std::vector<std::array<double, 2>> map;
};

CutMesh cut_mesh_of(const Tin& tin, const StoreFacts& facts) {
  CutMesh mesh;
  mesh.nodes.resize(tin.vertices.size());
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const GridPoint p = tin.position(v);
    const MapPoint map = facts.map.to_map(p.x, p.y);
    CutNode& node = mesh.nodes[v];
    node.at = {std::int64_t{p.x} << 22, std::int64_t{p.y} << 22};
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

LatticePoint lattice_point(MapPoint map, const StoreFacts& facts) {
  const MapPoint grid = facts.map.to_grid(map);
  const double x = grid.x * kLatticePerGrid;
  const double y = grid.y * kLatticePerGrid;
  if (!(std::abs(x) < kLatticeMax && std::abs(y) < kLatticeMax)) {
    throw Error(ErrorCode::invalid_argument,
                "the polygon reaches far beyond the terrain (2^38 grid units); give one near it");
  }
  return {std::llround(x), std::llround(y)};
}

void push(Ring& ring, MapPoint map, LatticePoint lattice) {
  if (!ring.lattice.empty() && ring.lattice.back() == lattice) return;
  ring.lattice.push_back(lattice);
  ring.map.push_back({map.x, map.y});
}

Ring ring_of(const Window& w, const StoreFacts& facts) {
  // A side outside of the terrain cuts nothing, wherever it is: so corners are clamped to near the
  // terrain.
  const auto lattice = [&](double x, double y) {
    const MapPoint grid = facts.map.to_grid({x, y});
    const GridBox& b = facts.bounds;
    return LatticePoint{
        std::llround(std::clamp(grid.x, b.min_x - 16.0, b.max_x + 16.0) * kLatticePerGrid),
        std::llround(std::clamp(grid.y, b.min_y - 16.0, b.max_y + 16.0) * kLatticePerGrid)};
  };
  Ring ring;
  for (const MapPoint corner : {MapPoint{w.min_x, w.min_y}, MapPoint{w.max_x, w.min_y},
                                MapPoint{w.max_x, w.max_y}, MapPoint{w.min_x, w.max_y}}) {
    push(ring, corner, lattice(corner.x, corner.y));
  }
  return ring;
}

std::vector<Ring> rings_of(const Region& region, const StoreFacts& facts) {
  std::vector<Ring> rings;
  if (const auto* window = std::get_if<Window>(&region)) {
    rings.push_back(ring_of(*window, facts));
  } else if (const auto* polygon = std::get_if<Polygon>(&region)) {
    for (const auto& points : polygon->rings) {
      Ring ring;
      for (const MapPoint p : points) push(ring, p, lattice_point(p, facts));
      rings.push_back(std::move(ring));
    }
  } else {
    throw Error(ErrorCode::invalid_argument,
                "only a window or a polygon can be cut to; a point has no inside");
  }
  for (Ring& ring : rings) {
    while (ring.lattice.size() > 1 && ring.lattice.front() == ring.lattice.back()) {
      ring.lattice.pop_back();
      ring.map.pop_back();
    }
  }
  return rings;
}

/// True when the segment may meet the box of the terrain; false is certain.
bool near_terrain(const BorderSegment& s, const GridBox& bounds) {
  const LatticePoint low{std::int64_t{bounds.min_x} << 22, std::int64_t{bounds.min_y} << 22};
  const LatticePoint high{std::int64_t{bounds.max_x} << 22, std::int64_t{bounds.max_y} << 22};
  if (std::max(s.from.x, s.to.x) < low.x || std::min(s.from.x, s.to.x) > high.x) return false;
  if (std::max(s.from.y, s.to.y) < low.y || std::min(s.from.y, s.to.y) > high.y) return false;
  int left = 0;
  int right = 0;
  for (const LatticePoint corner :
       {low, LatticePoint{high.x, low.y}, high, LatticePoint{low.x, high.y}}) {
    const double o = lattice_orient(s.from, s.to, corner);
    left += o > 0;
    right += o < 0;
  }
  return left < 4 && right < 4;
}

void insert_ring(CutMesh& mesh, const Ring& ring, const GridBox& bounds) {
  const std::size_t n = ring.lattice.size();
  if (n < 2) return;
  const GridBox& b = bounds;
  std::vector<std::uint32_t> ids(n, kNone);
  for (std::size_t i = 0; i < n; ++i) {
    const LatticePoint p = ring.lattice[i];
    const bool in_box = p.x >= std::int64_t{b.min_x} << 22 && p.x <= std::int64_t{b.max_x} << 22 &&
                        p.y >= std::int64_t{b.min_y} << 22 && p.y <= std::int64_t{b.max_y} << 22;
    if (in_box) ids[i] = mesh.insert_point(p, ring.map[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 == n ? 0 : i + 1;
    const BorderSegment segment{ring.lattice[i], ring.lattice[j], ring.map[i], ring.map[j]};
    if (ids[i] == kNone && ids[j] == kNone && !near_terrain(segment, bounds)) continue;
    mesh.insert_segment(segment, ids[i], ids[j]);
  }
}

bool is_inside(double x, double y, const std::vector<Ring>& rings) {
  bool inside = false;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0, j = ring.lattice.size() - 1; i < ring.lattice.size(); j = i++) {
      const double ax = static_cast<double>(ring.lattice[i].x);
      const double ay = static_cast<double>(ring.lattice[i].y);
      const double bx = static_cast<double>(ring.lattice[j].x);
      const double by = static_cast<double>(ring.lattice[j].y);
      if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) inside = !inside;
    }
  }
  return inside;
}

/// Whether each triangle is inside of the region. All triangles of a piece of the mesh between
/// borders have one answer, which is asked at the middle of the largest of them.
std::vector<bool> inside_of(const CutMesh& mesh, const std::vector<Ring>& rings) {
  std::vector<bool> inside(mesh.triangles.size(), false);
  std::vector<bool> seen(mesh.triangles.size(), false);
  std::vector<TriangleId> piece;
  for (TriangleId seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (seen[seed]) continue;
    piece.assign(1, seed);
    seen[seed] = true;
    TriangleId largest = seed;
    double largest_area = -1.0;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const CutTriangle& t = mesh.triangles[piece[k]];
      const double area =
          lattice_orient(mesh.nodes[t.v[0]].at, mesh.nodes[t.v[1]].at, mesh.nodes[t.v[2]].at);
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
    double x = 0;
    double y = 0;
    for (const auto v : mesh.triangles[largest].v) {
      x += static_cast<double>(mesh.nodes[v].at.x) / 3;
      y += static_cast<double>(mesh.nodes[v].at.y) / 3;
    }
    if (!is_inside(x, y, rings)) continue;
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
  const std::vector<bool> inside = inside_of(cut, rings);
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
