// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/tin_patch.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"

namespace ptin::tools {

namespace {

constexpr std::uint64_t kBytesAnOpenVertex = 64;  // a node of the table and its share of buckets

std::uint64_t position_of(GridPoint p) {
  return hilbert_position(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
}

/// The place (0, 1 or 2) of the corner that comes last along the curve.
int last_corner(const Triangle& t, const std::vector<std::uint64_t>& along) {
  const int a = along[t.v[0]] > along[t.v[1]] ? 0 : 1;
  return along[t.v[a]] > along[t.v[2]] ? a : 2;
}

}  // namespace

/// What a cell owns, sorted along the curve.
struct PatchMaker::Sorted {
  std::vector<VertexId> vertices;
  std::vector<std::uint32_t> rank;  ///< Place of each of tin.vertices in `vertices`, else kNone.
  /// How many triangles of later cells use each of `vertices`.
  std::vector<std::uint32_t> pending;
  struct Owned {
    std::uint32_t owner;             ///< Rank of the last corner.
    std::array<VertexId, 3> corner;  ///< The last corner first.
    std::uint64_t next;              ///< Curve position of corner[1].
  };
  std::vector<Owned> triangles;
};

TinPatch::Point TinPatch::point(const Corner& corner) const {
  const Vertex& v = tin->vertices[corner.local];
  const MapPoint at = facts->map.to_map(v.position.x, v.position.y);
  return {at.x, at.y, facts->heights.height(v.height)};
}

PatchMaker::PatchMaker(const StoreFile& store, const std::optional<Region>& region)
    : store_(store) {
  if (region) region_.emplace(*region, store.facts().map);
}

bool PatchMaker::is_wanted(const Tin& tin, TriangleId t) const {
  if (!tin.is_alive(t) || tin.classes[t] == TriangleClass::kVoid) return false;
  const Triangle& triangle = tin.triangles[t];
  return !region_ || region_->meets(tin.position(triangle.v[0]), tin.position(triangle.v[1]),
                                    tin.position(triangle.v[2]));
}

PatchMaker::Sorted PatchMaker::sort_cell(const GridCell& cell, const Tin& tin) const {
  const std::size_t n = tin.vertices.size();
  std::vector<std::uint64_t> along(n);
  std::vector<bool> inside(n);
  for (std::size_t v = 0; v < n; ++v) {
    along[v] = position_of(tin.vertices[v].position);
    inside[v] = cell.holds(tin.vertices[v].position);
  }
  Sorted sorted;
  sorted.rank.assign(n, kNone);
  // First the cell's vertices and triangles are found, then they are sorted.
  std::vector<TriangleId> owned;
  std::vector<TriangleId> later;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& triangle = tin.triangles[t];
    if (triangle.v[0] == kNone ||
        !(inside[triangle.v[0]] || inside[triangle.v[1]] || inside[triangle.v[2]]) ||
        !is_wanted(tin, t)) {
      continue;
    }
    const bool is_owned = inside[triangle.v[last_corner(triangle, along)]];
    (is_owned ? owned : later).push_back(t);
    for (const VertexId v : triangle.v) {
      if (inside[v] && sorted.rank[v] == kNone) {
        sorted.rank[v] = 0;
        sorted.vertices.push_back(v);
      }
    }
  }
  std::sort(sorted.vertices.begin(), sorted.vertices.end(),
            [&](VertexId a, VertexId b) { return along[a] < along[b]; });
  for (std::uint32_t i = 0; i < sorted.vertices.size(); ++i) sorted.rank[sorted.vertices[i]] = i;
  sorted.pending.assign(sorted.vertices.size(), 0);
  for (const TriangleId t : later) {
    for (const VertexId v : tin.triangles[t].v) {
      if (inside[v]) ++sorted.pending[sorted.rank[v]];
    }
  }
  sorted.triangles.reserve(owned.size());
  for (const TriangleId t : owned) {
    const Triangle& triangle = tin.triangles[t];
    const int c = last_corner(triangle, along);
    const VertexId next = triangle.v[next_corner(c)];
    sorted.triangles.push_back({sorted.rank[triangle.v[c]],
                                {triangle.v[c], next, triangle.v[previous_corner(c)]},
                                along[next]});
  }
  std::sort(sorted.triangles.begin(), sorted.triangles.end(),
            [](const Sorted::Owned& a, const Sorted::Owned& b) {
              return a.owner != b.owner ? a.owner < b.owner : a.next < b.next;
            });
  return sorted;
}

void PatchMaker::throw_damaged() const {
  throw Error(ErrorCode::corruption,
              "the parts of the terrain do not join; run verify, and build the file again",
              store_.path());
}

std::uint64_t PatchMaker::number_of(VertexId v, const Tin& tin, const Sorted& sorted) {
  if (sorted.rank[v] != kNone) return vertices_ + sorted.rank[v];
  const auto found = open_.find(key_of(tin.position(v)));
  if (found == open_.end()) throw_damaged();
  const std::uint64_t number = found->second.number;
  if (--found->second.triangles == 0) open_.erase(found);
  return number;
}

TinPatch PatchMaker::make(const GridCell& cell, const Tin& tin, std::uint64_t border_limit_bytes) {
  const Sorted sorted = sort_cell(cell, tin);
  TinPatch patch;
  patch.tin = &tin;
  patch.facts = &store_.facts();
  patch.first_vertex = vertices_;
  patch.vertices.reserve(sorted.vertices.size());
  for (const VertexId v : sorted.vertices) patch.vertices.push_back(patch.point({0, v}));
  patch.triangles.reserve(sorted.triangles.size());
  for (const Sorted::Owned& t : sorted.triangles) {
    std::array<TinPatch::Corner, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = {number_of(t.corner[i], tin, sorted), t.corner[i]};
    }
    patch.triangles.push_back(corners);
  }
  for (std::uint32_t i = 0; i < sorted.vertices.size(); ++i) {
    if (sorted.pending[i] == 0) continue;
    open_.insert({key_of(tin.position(sorted.vertices[i])), {vertices_ + i, sorted.pending[i]}});
  }
  if (open_.size() * kBytesAnOpenVertex > border_limit_bytes) {
    throw Error(ErrorCode::resource_exhausted,
                "the border between parts takes more than its share of the memory; give more "
                "--memory",
                store_.path());
  }
  vertices_ += sorted.vertices.size();
  triangles_ += sorted.triangles.size();
  return patch;
}

void PatchMaker::finish() const {
  if (!open_.empty()) throw_damaged();
}

}  // namespace ptin::tools
