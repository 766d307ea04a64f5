// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_mend.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "engine/construct/grid/point_order.h"
#include "engine/construct/tin/tin_faults.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// The result of taking slivers away by flips of edges.
struct SliverFlips {
  std::uint64_t mended = 0;  ///< Bad triangles that were taken away: slivers, and what flips made.
  /// Ends of edges beyond which there may be a triangle of the mesh that is not at hand. Where
  /// there are any, the triangles at hand are to be thrown away, and the work is to be done again
  /// with all triangles around these vertices.
  std::vector<VertexId> beyond;
};

class Flipper {
 public:
  Flipper(std::span<const GridPoint> positions, std::vector<Corners>& triangles,
          std::span<const std::uint8_t> is_complete)
      : positions_(positions), triangles_(triangles), is_complete_(is_complete) {
    sides_.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      add_sides(t);
    }
  }

  SliverFlips run(std::vector<std::uint32_t> open) {
    // A flip makes two triangles, which may be bad again: without a limit this might never end.
    std::uint64_t left = 64 * open.size();
    SliverFlips flips;
    while (!open.empty() && left-- > 0) {
      const std::uint32_t t = open.back();
      open.pop_back();
      if (is_gone(t) || is_good(t)) {
        continue;
      }
      ++flips.mended;
      mend(t, open);
    }
    std::erase_if(triangles_, [](const Corners& c) { return c[0] == kNone; });
    flips.beyond = std::move(beyond_);
    return flips;
  }

 private:
  static std::uint64_t side(VertexId from, VertexId to) { return (std::uint64_t{from} << 32) | to; }
  [[nodiscard]] bool is_gone(std::uint32_t t) const { return triangles_[t][0] == kNone; }
  [[nodiscard]] bool is_good(std::uint32_t t) const {
    const Corners& c = triangles_[t];
    return orient(positions_[c[0]], positions_[c[1]], positions_[c[2]]) > 0;
  }
  [[nodiscard]] std::int64_t length_squared(VertexId a, VertexId b) const {
    const std::int64_t dx = std::int64_t{positions_[a].x} - positions_[b].x;
    const std::int64_t dy = std::int64_t{positions_[a].y} - positions_[b].y;
    return dx * dx + dy * dy;
  }

  void add_sides(std::uint32_t t) {
    const Corners& c = triangles_[t];
    for (std::size_t i = 0; i < 3; ++i) {
      sides_[side(c[i], c[(i + 1) % 3])] = t;
    }
  }
  void remove(std::uint32_t t) {
    const Corners c = triangles_[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = sides_.find(side(c[i], c[(i + 1) % 3]));
      if (found != sides_.end() && found->second == t) {
        sides_.erase(found);
      }
    }
    triangles_[t] = {kNone, kNone, kNone};
  }
  void put(std::uint32_t t, const Corners& corners, std::vector<std::uint32_t>& open) {
    triangles_[t] = corners;
    add_sides(t);
    if (!is_good(t)) {
      open.push_back(t);
    }
  }

  void mend(std::uint32_t t, std::vector<std::uint32_t>& open) {
    Corners c = triangles_[t];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      remove(t);
      return;
    }
    // Turned so that the longest edge runs from a to b, opposite to the apex.
    std::array<std::int64_t, 3> lengths{};
    for (std::size_t i = 0; i < 3; ++i) {
      lengths[i] = length_squared(c[(i + 1) % 3], c[(i + 2) % 3]);
    }
    std::rotate(c.begin(),
                c.begin() + (std::max_element(lengths.begin(), lengths.end()) - lengths.begin()),
                c.end());
    const VertexId apex = c[0], a = c[1], b = c[2];
    const auto found = sides_.find(side(b, a));
    if (found == sides_.end()) {
      if (is_complete_[a] == 0 && is_complete_[b] == 0) {
        beyond_.insert(beyond_.end(), {a, b});
      }
      remove(t);
      return;
    }
    const std::uint32_t u = found->second;
    const Corners d = triangles_[u];
    const VertexId opposite =
        d[0] != a && d[0] != b ? d[0] : (d[1] != a && d[1] != b ? d[1] : d[2]);
    remove(t);
    remove(u);
    put(t, {apex, a, opposite}, open);
    put(u, {apex, opposite, b}, open);
  }

  std::span<const GridPoint> positions_;
  std::vector<Corners>& triangles_;
  std::span<const std::uint8_t> is_complete_;
  std::vector<VertexId> beyond_;
  std::unordered_map<std::uint64_t, std::uint32_t> sides_;
};

/// Mends slivers: triangles that were counter-clockwise before their corners were snapped to the
/// grid, and are not any more. A sliver with two corners on one place is removed, and so is a
/// sliver whose longest edge lies on the border. The longest edge of any other sliver is flipped; a
/// triangle that the flip makes and that is bad too is mended in the same way. After 64 steps for
/// each sliver that was given the rest of them stay in `triangles`.
/// @param positions    Positions of the vertices, by id.
/// @param triangles    A part of a mesh. Removing triangles changes the indices of others.
/// @param slivers      Indices into `triangles`.
/// @param is_complete  By `positions`: 1 where all triangles of the mesh at a vertex are given.
/// Cost: O(n) expected for n triangles when there is a sliver, else nothing.
SliverFlips flip_slivers(std::span<const GridPoint> positions, std::vector<Corners>& triangles,
                         std::vector<std::uint32_t> slivers,
                         std::span<const std::uint8_t> is_complete) {
  return slivers.empty() ? SliverFlips{}
                         : Flipper(positions, triangles, is_complete).run(std::move(slivers));
}

/// Most triangles of a patch.
constexpr std::uint64_t kMostAround = 1 << 20;

/// What a triangle of a patch takes in memory while it is made and mended.
constexpr std::uint64_t kBytesOfPatchTriangle = 256;

using KeySet = std::unordered_set<VertexKey>;

/// All triangles at some vertices, in memory.
struct Patch {
  std::vector<GridVertex> vertices;       ///< In the order of their keys.
  std::vector<GridPoint> positions;       ///< Those of `vertices`.
  std::vector<std::uint8_t> is_complete;  ///< 1 for vertices all of whose triangles are here.
  std::vector<Corners> triangles;

  [[nodiscard]] VertexId number(VertexKey key) const { return vertex_number(vertices, key); }
  [[nodiscard]] Corners numbers(const GridTriangle& t) const {
    return {number(key_of(t.corners[0].position)), number(key_of(t.corners[1].position)),
            number(key_of(t.corners[2].position))};
  }
};

bool touches(const GridTriangle& t, const KeySet& vertices) {
  return std::any_of(t.corners.begin(), t.corners.end(),
                     [&](const GridVertex& v) { return vertices.contains(key_of(v.position)); });
}

bool fits(std::uint64_t triangles, const ExternalMemory& memory) {
  return triangles <= kMostAround &&
         triangles * kBytesOfPatchTriangle <= std::max<std::uint64_t>(memory.bytes, 1U << 16);
}

void require_fit(std::uint64_t triangles, const ExternalMemory& memory, const std::string& path) {
  if (fits(triangles, memory)) {
    return;
  }
  const std::string found = "so many triangles are flattened by the grid that " +
                            std::to_string(triangles) + " lie around them, ";
  if (triangles > kMostAround) {
    throw Error(ErrorCode::resource_exhausted,
                found + "and " + std::to_string(kMostAround) +
                    " can be mended; give a finer --resolution, or let --repair triangulate the "
                    "points anew",
                path);
  }
  throw Error(ErrorCode::resource_exhausted,
              found + "which take " +
                  std::to_string((triangles * kBytesOfPatchTriangle >> 20) + 1) +
                  "M of memory, and " + std::to_string(memory.bytes >> 20) +
                  "M are free for them; give more --memory, or a finer --resolution",
              path);
}

/// The patch of all triangles with a corner in `wanted`.
Patch patch_around(const RecordFile<GridTriangle>& mesh, const KeySet& wanted,
                   const ExternalMemory& memory, const std::string& path,
                   const std::stop_token& stop) {
  std::vector<GridTriangle> found;
  std::uint64_t around = 0;  // all are counted, even where they do not fit: the error says how many
  mesh.visit(
      [&](const GridTriangle& t) {
        if (touches(t, wanted) && fits(++around, memory)) {
          found.push_back(t);
        }
      },
      stop);
  require_fit(around, memory, path);
  Patch patch;
  patch.vertices = vertices_of(found);
  patch.vertices.shrink_to_fit();
  for (const GridVertex& v : patch.vertices) {
    patch.positions.push_back(v.position);
    patch.is_complete.push_back(wanted.contains(key_of(v.position)) ? 1 : 0);
  }
  for (const GridTriangle& t : found) {
    patch.triangles.push_back(patch.numbers(t));
  }
  return patch;
}

/// The mesh with `patch`, which is sorted as it is, in the place of the triangles with a corner in
/// `wanted`.
RecordFile<GridTriangle> replaced(const RecordFile<GridTriangle>& mesh, const KeySet& wanted,
                                  const std::vector<GridTriangle>& patch,
                                  const ExternalMemory& memory, const std::stop_token& stop) {
  RecordFile<GridTriangle> to(memory, "triangles");
  std::size_t next = 0;
  const auto add_before = [&](const GridTriangle* t) {
    for (; next < patch.size() && (t == nullptr || patch[next] < *t); ++next) {
      to.add(patch[next]);
    }
  };
  mesh.visit(
      [&](const GridTriangle& t) {
        if (!touches(t, wanted)) {
          add_before(&t);
          to.add(t);
        }
      },
      stop);
  add_before(nullptr);
  to.finish();
  return to;
}

/// Removes the places of vertices that have lost all their triangles.
void drop_lone(RecordFile<std::uint64_t>& places, const Patch& patch, const PointOrder& order,
               const ExternalMemory& memory, const std::stop_token& stop) {
  std::vector<std::uint8_t> is_used(patch.vertices.size(), 0);
  for (const Corners& t : patch.triangles) {
    is_used[t[0]] = is_used[t[1]] = is_used[t[2]] = 1;
  }
  std::unordered_set<std::uint64_t> lone;
  for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
    if (is_used[v] == 0 && patch.is_complete[v] != 0) {
      lone.insert(order.key(patch.positions[v]));
    }
  }
  if (lone.empty()) {
    return;
  }
  RecordFile<std::uint64_t> kept(memory, "places");
  places.visit(
      [&](std::uint64_t place) {
        if (!lone.contains(place)) {
          kept.add(place);
        }
      },
      stop);
  kept.finish();
  places = std::move(kept);
}

/// Flips slivers in a patch that grows until no flip needs a triangle outside of it.
/// @param wanted  Vertices whose triangles the patch holds; grows with it.
/// @param patch   Receives the patch with mended triangles.
SliverFlips mend(const RecordFile<GridTriangle>& mesh, const std::vector<GridTriangle>& slivers,
                 KeySet& wanted, Patch& patch, const ExternalMemory& memory,
                 const std::string& path, const std::stop_token& stop) {
  while (true) {
    patch = {};
    patch = patch_around(mesh, wanted, memory, path, stop);
    std::vector<Corners> bad;
    for (const GridTriangle& t : slivers) {
      bad.push_back(patch.numbers(t));
    }
    std::sort(bad.begin(), bad.end());
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) {
      if (std::binary_search(bad.begin(), bad.end(), patch.triangles[t])) {
        numbers.push_back(t);
      }
    }
    SliverFlips flips =
        flip_slivers(patch.positions, patch.triangles, std::move(numbers), patch.is_complete);
    if (flips.beyond.empty()) {
      return flips;
    }
    for (const VertexId v : flips.beyond) {
      wanted.insert(key_of(patch.positions[v]));
    }
  }
}

}  // namespace

std::uint64_t mend_slivers(MeshOnDisk& mesh, const std::vector<GridTriangle>& slivers,
                           const PointOrder& order, const ExternalMemory& memory, TinFaults& faults,
                           const std::string& path, const std::stop_token& stop) {
  if (slivers.empty()) {
    return 0;
  }
  KeySet wanted;
  for (const GridTriangle& t : slivers) {
    for (const GridVertex& v : t.corners) {
      wanted.insert(key_of(v.position));
    }
  }
  Patch patch;
  const SliverFlips flips = mend(mesh.triangles, slivers, wanted, patch, memory, path, stop);
  std::vector<GridTriangle> mended;
  for (const Corners& t : patch.triangles) {
    mended.push_back(
        grid_triangle({patch.vertices[t[0]], patch.vertices[t[1]], patch.vertices[t[2]]}, order));
    const std::int64_t area = mended.back().area();
    if (area <= 0) {
      (area == 0 ? faults.no_area : faults.turned_over).add(mended.back().corners[0].position);
    }
  }
  std::sort(mended.begin(), mended.end());
  mesh.triangles = replaced(mesh.triangles, wanted, mended, memory, stop);
  drop_lone(mesh.places, patch, order, memory, stop);
  return flips.mended;
}

}  // namespace ptin
