// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_mend.h"

#include <algorithm>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "engine/construct/grid/point_order.h"
#include "engine/construct/tin/sliver_flips.h"
#include "engine/construct/tin/tin_faults.h"
#include "engine/error.h"

namespace ptin {

namespace {

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
