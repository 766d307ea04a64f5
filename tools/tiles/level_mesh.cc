// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/level_mesh.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/error.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

/// An edge is halved at most so often: 2^-20 of the Earth's girth is 40 m.
constexpr int kMostHalvings = 40;

}  // namespace

LevelMesh::LevelMesh(LevelFrame frame, const GlobePath& path, const TileBox& keep,
                     std::uint64_t most_triangles)
    : frame_(frame),
      path_(path),
      keep_(keep),
      most_triangles_(most_triangles),
      // The Earth falls away from a chord of length d by d^2 / 8 R. Up to an eighth of what is
      // allowed, edges are taken as they are.
      short_square_(kSemiMinor * frame.plan.chord),
      // An edge is about sqrt(8 R chord) long at most: 2^50 of these units are twice the area of
      // a triangle with such edges, so thousands of triangles may share a vertex.
      normal_scale_(std::ldexp(1.0, 50 - std::ilogb(8 * kSemiMajor * frame.plan.chord))) {}

LevelMesh::Id LevelMesh::add_vertex(double x, double y, double height) {
  const GlobePoint p = path_.to_globe(x, y, height);
  points_.push_back({frame_.grid.lattice_point(frame_.level, p.lon, p.lat), p.height, {}});
  places_.push_back({x, y, height, ecef_of(p)});
  return static_cast<Id>(points_.size() - 1);
}

LevelMesh::Id LevelMesh::middle_of(Id a, Id b) {
  const double x = 0.5 * (places_[a].x + places_[b].x);
  const double y = 0.5 * (places_[a].y + places_[b].y);
  const auto [it, is_new] = middles_.try_emplace({x, y}, kNone);
  if (is_new) it->second = add_vertex(x, y, 0.5 * (places_[a].height + places_[b].height));
  return it->second;
}

bool LevelMesh::is_too_long(Id a, Id b) {
  const Vec3 chord = places_[a].in_space - places_[b].in_space;
  if (dot(chord, chord) <= short_square_) return false;
  const Vec3 middle = 0.5 * (places_[a].in_space + places_[b].in_space);
  return length(places_[middle_of(a, b)].in_space - middle) > frame_.plan.chord;
}

TileBox LevelMesh::box_of(const Corners& t) const noexcept {
  TileBox box;
  for (const Id v : t) box.add(points_[v].at);
  return box;
}

std::array<std::int64_t, 3> LevelMesh::normal_of(const Corners& t) const noexcept {
  const Vec3& a = places_[t[0]].in_space;
  const Vec3 n = cross(places_[t[1]].in_space - a, places_[t[2]].in_space - a);
  const auto rounded = [&](double v) {
    constexpr double kMost = 0x1p56;
    return std::llround(std::clamp(v * normal_scale_, -kMost, kMost));
  };
  return {rounded(n.x), rounded(n.y), rounded(n.z)};
}

void LevelMesh::keep_triangle(const Corners& given) {
  // The least corner first: the normal is computed from the same corner in every mesh.
  Corners t = given;
  const auto before = [&](Id a, Id b) {
    return std::pair(places_[a].y, places_[a].x) < std::pair(places_[b].y, places_[b].x);
  };
  std::rotate(t.begin(), std::min_element(t.begin(), t.end(), before), t.end());
  if (triangles_.size() >= most_triangles_) {
    throw Error(ErrorCode::resource_exhausted,
                "the tile takes more than its memory: " + std::to_string(most_triangles_) +
                    " triangles; give more memory");
  }
  triangles_.push_back(t);
  const std::array<std::int64_t, 3> normal = normal_of(t);
  for (const Id v : t) {
    for (std::size_t i = 0; i < 3; ++i) points_[v].normal[i] += normal[i];
  }
}

void LevelMesh::add_triangle(const Corners& t, int depth) {
  int longest = -1;
  double most = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Id a = t[static_cast<std::size_t>(next_corner(i))];
    const Id b = t[static_cast<std::size_t>(previous_corner(i))];
    if (depth >= kMostHalvings || !is_too_long(a, b)) continue;
    const Vec3 side = places_[a].in_space - places_[b].in_space;
    if (dot(side, side) > most) {
      most = dot(side, side);
      longest = i;
    }
  }
  const TileBox box = box_of(t);
  if (longest < 0) {
    if (box.meets(keep_)) keep_triangle(t);
    return;
  }
  // What is bent leaves the box of its corners by less than a quarter of its length.
  if (!box.widened((box.max_u - box.min_u + box.max_v - box.min_v) / 4 + 1,
                   (box.max_u - box.min_u + box.max_v - box.min_v) / 4 + 1)
           .meets(keep_)) {
    return;
  }
  const Id top = t[static_cast<std::size_t>(longest)];
  const Id a = t[static_cast<std::size_t>(next_corner(longest))];
  const Id b = t[static_cast<std::size_t>(previous_corner(longest))];
  const Id middle = middle_of(a, b);
  add_triangle({top, a, middle}, depth + 1);
  add_triangle({top, middle, b}, depth + 1);
}

void LevelMesh::add(const Tin& tin, const StoreFacts& facts, const std::stop_token& stop) {
  std::vector<Id> ids(tin.vertices.size(), kNone);
  const auto id_of = [&](VertexId v) {
    if (ids[v] == kNone) {
      const GridPoint p = tin.position(v);
      ids[v] = add_vertex(p.x, p.y, facts.heights.height(tin.vertices[v].height));
    }
    return ids[v];
  };
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) stop_if_asked(stop, "the tile");
    if (tin.classes[t] != TriangleClass::kSurface) continue;
    const auto& v = tin.triangles[t].v;
    add_triangle({id_of(v[0]), id_of(v[1]), id_of(v[2])}, 0);
  }
}

}  // namespace ptin::tools
