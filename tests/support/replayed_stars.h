// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stars with lifetimes of any hierarchy of splits, found by making the splits: for tests that have
// records and want a store.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "engine/mesh/split.h"
#include "engine/mesh/star.h"
#include "storage/error_table.h"
#include "storage/packed_segment.h"
#include "storage/page_packer.h"
#include "storage/record_order.h"
#include "storage/short_float.h"
#include "storage/star.h"
#include "storage/store_file.h"

namespace ptin::test {

/// Gives records their stars, and the triangles of T0 their deaths.
/// @param t0        As a mesh, and what is stored of it; the triangles of both in one order.
/// @param records   All records of the hierarchy, in any order.
/// @returns         The records in that order, with their stars.
inline StarredRecords replayed_stars(Tin t0, CoarsestTin& stored,
                                     std::span<const VertexSplit> records) {
  struct Slot {
    std::size_t record, corner;
  };
  constexpr std::size_t kOfT0 = SIZE_MAX;
  Tin tin = std::move(t0);
  std::map<VertexKey, VertexId> vertices;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    vertices[key_of(tin.position(v))] = v;
  }
  std::vector<Slot> slots;  // of each triangle: the star that made it
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    slots.push_back({kOfT0, t});
  }
  std::vector<std::size_t> order(records.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return records[a].rank > records[b].rank; });
  std::vector<std::vector<RingCorner>> rings(records.size());
  Star star;
  for (const std::size_t i : order) {
    const VertexSplit& r = records[i];
    const auto u = static_cast<VertexId>(tin.vertices.size());
    tin.vertices.push_back({r.u, r.height, kNone});
    tin.has_height.push_back((r.flags & VertexSplit::kVertexVoid) == 0 ? 1 : 0);
    vertices[key_of(r.u)] = u;
    const auto class_of = [&](VertexSplit::Flag flag) {
      return (r.flags & flag) != 0 ? TriangleClass::kVoid : TriangleClass::kSurface;
    };
    const SplitResult made = split(
        tin, {u, vertices.at(key_of(r.w)), vertices.at(key_of(r.vl)), vertices.at(key_of(r.vr)),
              (r.flags & VertexSplit::kNoLeft) == 0, (r.flags & VertexSplit::kNoRight) == 0,
              class_of(VertexSplit::kLeftVoid), class_of(VertexSplit::kRightVoid)});
    if (!made.applied) {
      throw std::runtime_error("a split does not find its fan");
    }
    slots.resize(tin.triangles.size(), {kOfT0, 0});
    walk_star(tin, u, star);
    // A closed ring begins at w.
    const auto w = std::find(star.link.begin(), star.link.end(), vertices.at(key_of(r.w)));
    const auto first = star.closed ? static_cast<std::size_t>(w - star.link.begin()) : 0;
    for (std::size_t k = 0; k < star.link.size(); ++k) {
      const std::size_t at = (first + k) % star.link.size();
      const VertexId v = star.link[at];
      RingCorner c{tin.position(v), tin.vertices[v].height, kLivesOn, 0};
      if (tin.has_height[v] == 0) {
        c.height = 0;
        c.flags = RingCorner::kNoHeight;
      }
      if (at < star.triangles.size()) {
        const TriangleId t = star.triangles[at];
        if (t != made.left && t != made.right) {
          const Slot was = slots[t];
          (was.record == kOfT0 ? stored.triangles[was.corner].death
                               : rings[was.record][was.corner].death) = r.error;
        }
        slots[t] = {i, k};
        if (tin.classes[t] == TriangleClass::kVoid) {
          c.flags = static_cast<std::uint8_t>(c.flags | RingCorner::kVoid);
        }
      }
      rings[i].push_back(c);
    }
  }
  StarredRecords result;
  result.splits.assign(records.begin(), records.end());
  for (const std::vector<RingCorner>& ring : rings) {
    result.corners.insert(result.corners.end(), ring.begin(), ring.end());
    result.ring_end.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  return result;
}

/// The records [begin, end), with their stars.
inline StarredRecords part_of(const StarredRecords& records, std::size_t begin, std::size_t end) {
  StarredRecords part;
  for (std::size_t i = begin; i < end; ++i) {
    part.splits.push_back(records.splits[i]);
    const auto ring = records.ring(i);
    part.corners.insert(part.corners.end(), ring.begin(), ring.end());
    part.ring_end.push_back(static_cast<std::uint32_t>(part.corners.size()));
  }
  return part;
}

/// The stars of records of which some were changed since: rings as they were, but for the corners
/// and classes that the record names, and for deaths above its error.
/// @param sound  The records before the change, with their stars.
inline StarredRecords changed_stars(const StarredRecords& sound,
                                    std::span<const VertexSplit> records) {
  std::map<VertexKey, std::size_t> place;
  for (std::size_t i = 0; i < sound.size(); ++i) {
    place[key_of(sound.splits[i].u)] = i;
  }
  StarredRecords result;
  for (std::size_t i = 0; i < records.size(); ++i) {
    VertexSplit r = records[i];
    r.error = shortened(r.error);
    r.deviation = shortened(r.deviation);
    const auto found = place.find(key_of(r.u));
    const auto was = sound.ring(found != place.end() ? found->second : i);
    std::vector<RingCorner> ring(was.begin(), was.end());
    const bool no_left = (r.flags & VertexSplit::kNoLeft) != 0;
    const std::size_t last = ring.size() - 1;
    const std::size_t vr = no_left ? last - 1 : last;
    ring[no_left ? last : 0].position = r.w;
    ring[no_left ? 0 : 1].position = r.vl;
    ring[vr].position = r.vr;
    const auto set_void = [&](RingCorner& c, VertexSplit::Flag flag) {
      const unsigned others = c.flags & ~unsigned{RingCorner::kVoid};
      c.flags =
          static_cast<std::uint8_t>((r.flags & flag) != 0 ? others | RingCorner::kVoid : others);
    };
    if (!no_left) {
      set_void(ring[0], VertexSplit::kLeftVoid);
    }
    if ((r.flags & VertexSplit::kNoRight) == 0) {
      set_void(ring[vr], VertexSplit::kRightVoid);
    }
    for (RingCorner& c : ring) {
      c.death = std::min(c.death, r.error);
    }
    result.splits.push_back(r);
    result.corners.insert(result.corners.end(), ring.begin(), ring.end());
    result.ring_end.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  return result;
}

/// As pack_segment(), for records that no reader may accept.
inline PackedSegment pack_unchecked(const StarredRecords& records, const HeightEncoding& heights,
                                    std::uint32_t page_bytes) {
  PackedSegment packed;
  PagePacker page(page_bytes, heights, {}, PagePacker::Packing::kAgain);
  ErrorTable errors;
  const auto finish = [&] {
    layout::NodeEntry descriptor;
    const auto bytes = page.finish(descriptor);
    packed.pages.insert(packed.pages.end(), bytes.begin(), bytes.end());
    packed.descriptors.push_back(descriptor);
  };
  for (const std::uint32_t i : order_of_segment(records)) {
    if (!page.add(records.splits[i], records.ring(i))) {
      finish();
      (void)page.add(records.splits[i], records.ring(i));
    }
    VertexSplit stored = records.splits[i];
    stored.error = shortened(stored.error);
    stored.deviation = shortened(stored.deviation);
    errors.add(stored);
    packed.max_rank = std::max(packed.max_rank, stored.rank);
  }
  if (!page.empty()) {
    finish();
  }
  packed.errors = errors.bins();
  return packed;
}

}  // namespace ptin::test
