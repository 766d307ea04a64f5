// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a finished tile to its parent, in two steps. Each takes its tiles over, shares nothing with
// other threads, and frees what it has used.
//
// push_up() cuts a tile down to what its parent needs:
// 1. Alive vertices and triangles get new numbers in their old order, so that nothing that is
//    decided by order changes.
// 2. Only records stay that a triangle carries: the parent's records will depend on no others.
//    `exported` remembers which they are, for tightening. All of them, and the stars, are
//    handed back beside the pushed tile.
// 3. Triangles are copied by these numbers, with all their samples (from a leaf) or with a few
//    carried samples (from any other tile). The old tile is freed.
// Between the steps the pushed tile lies in memory (leaves) or in a file
// (construct/hierarchy/tile_files.h).
//
// join_tiles() makes one tile of up to four pushed ones, each of which counts from 0:
// 1. Vertices come first, since triangles need their numbers: all are sorted by key, and those of
//    one key, on a common seam, become one.
// 2. Triangles, records and samples are appended part by part, with shifted numbers. A part is
//    freed before the next one is copied, so that the whole is never there twice.
// 3. link_sides() makes neighbours of triangles that share a seam edge.
// 4. settle_vertices() counts degrees, and finds each vertex the triangle where the walk around it
//    begins: both change on seams.
// 5. lock_seams() locks what is on a seam of the parent. Common seams are free to collapse.
#include "engine/construct/hierarchy/tile_push.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/check.h"
#include "engine/construct/collapse/carried_samples.h"
#include "engine/mesh/compact.h"
#include "engine/mesh/link.h"

namespace ptin {

namespace {

Renumbering keep_vertices(const Tile& from, Tile& to) {
  Renumbering place(from.tin.vertices.size(), kNone);
  for (VertexId v = 0; v < from.tin.vertices.size(); ++v) {
    if (from.tin.vertices[v].triangle != kNone) {
      place[v] = static_cast<std::uint32_t>(to.tin.vertices.size());
      to.tin.vertices.push_back(from.tin.vertices[v]);
      to.tin.has_height.push_back(from.tin.has_height[v]);
      to.vertex_state.push_back(from.vertex_state[v]);
    }
  }
  return place;
}

Renumbering keep_triangles(const Tile& from) {
  Renumbering place(from.tin.triangles.size(), kNone);
  std::uint32_t next = 0;
  for (TriangleId t = 0; t < from.tin.triangles.size(); ++t) {
    if (from.tin.is_alive(t)) {
      place[t] = next++;
    }
  }
  return place;
}

/// The records that some triangle carries, ascending.
std::vector<std::uint32_t> carried_records(const Tile& tile) {
  std::vector<std::uint32_t> records;
  for (TriangleId t = 0; t < tile.tin.triangles.size(); ++t) {
    if (tile.tin.is_alive(t) && tile.carried[t].record != kNone) {
      records.push_back(tile.carried[t].record);
    }
  }
  std::sort(records.begin(), records.end());
  records.erase(std::unique(records.begin(), records.end()), records.end());
  return records;
}

std::uint32_t mapped(const Renumbering& place, std::uint32_t i) {
  return i == kNone ? kNone : place[i];
}

void keep_all_samples(const Tile& from, TriangleId t, CarriedState& state, Tile& to) {
  const auto samples = from.samples.samples(from.carried[t].samples);
  state.samples = to.samples.take(static_cast<std::uint32_t>(samples.size()));
  std::copy(samples.begin(), samples.end(), to.samples.samples(state.samples).begin());
}

void keep_carried_samples(const Tile& from, TriangleId t, std::vector<Sample>& scratch,
                          CarriedState& state, Tile& to) {
  const auto samples = from.samples.samples(from.carried[t].samples);
  scratch.assign(samples.begin(), samples.end());
  choose_carried_samples(from, t, scratch);
  state.samples = to.samples.take(static_cast<std::uint32_t>(scratch.size()));
  std::copy(scratch.begin(), scratch.end(), to.samples.samples(state.samples).begin());
  state.holds_heights = state.holds_voids = false;
  for (const Sample& s : scratch) {
    (s.reach < 0.0F ? state.holds_voids : state.holds_heights) = true;
  }
}

/// Joins the vertices of parts. Returns for each part, beside its vertices, their new numbers.
std::vector<Renumbering> join_vertices(const std::vector<Tile>& parts, Tile& to) {
  struct Entry {
    VertexKey key;
    std::uint32_t part;
    VertexId vertex;
  };
  std::vector<Entry> entries;
  std::vector<Renumbering> place;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    place.emplace_back(parts[p].tin.vertices.size(), kNone);
    for (VertexId v = 0; v < parts[p].tin.vertices.size(); ++v) {
      entries.push_back({key_of(parts[p].tin.position(v)), p, v});
    }
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.part < b.part;
  });
  VertexKey last = kNoVertexKey;
  for (const Entry& e : entries) {
    if (e.key != last) {
      last = e.key;
      to.tin.vertices.push_back(parts[e.part].tin.vertices[e.vertex]);
      to.tin.has_height.push_back(parts[e.part].tin.has_height[e.vertex]);
      to.vertex_state.push_back(parts[e.part].vertex_state[e.vertex]);
    } else {  // leaves may know different parts of the border
      float& reach = to.vertex_state.back().reach;
      const float other = parts[e.part].vertex_state[e.vertex].reach;
      reach = std::abs(other) > std::abs(reach) ? other : reach;
    }
    place[e.part][e.vertex] = static_cast<std::uint32_t>(to.tin.vertices.size() - 1);
  }
  return place;
}

/// Gives every vertex a triangle as I6 asks, and its degree.
void settle_vertices(Tile& tile) {
  Tin& tin = tile.tin;
  for (VertexState& v : tile.vertex_state) {
    v.degree = 0;
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (const VertexId v : tin.triangles[t].v) {
      tin.vertices[v].triangle = t;
      ++tile.vertex_state[v].degree;
    }
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& triangle = tin.triangles[t];
    for (int i = 0; i < 3; ++i) {
      if (triangle.n[i] == kNone) {  // a border edge: the walk around its first end begins here
        tin.vertices[triangle.v[next_corner(i)]].triangle = t;
        ++tile.vertex_state[triangle.v[previous_corner(i)]].degree;
      }
    }
  }
}

}  // namespace

PushedTile push_up(Tile&& tile, PushedSamples samples) {
  PushedTile pushed;
  Tile& to = pushed.tile;
  to.units = tile.units;
  to.samples_fill_grid = tile.samples_fill_grid;
  to.has_voids = tile.has_voids;
  const Renumbering vertices = keep_vertices(tile, to);
  const Renumbering triangles = keep_triangles(tile);
  pushed.exported = carried_records(tile);
  Renumbering records(tile.records.size(), kNone);
  for (const std::uint32_t r : pushed.exported) {
    records[r] = static_cast<std::uint32_t>(to.records.size());
    to.records.push_back(tile.records[r]);
  }
  std::vector<Sample> scratch;
  if (samples == PushedSamples::kAll) {
    to.samples.reserve(tile.samples.used());
  }
  for (TriangleId t = 0; t < tile.tin.triangles.size(); ++t) {
    if (triangles[t] == kNone) {
      continue;
    }
    Triangle triangle = tile.tin.triangles[t];
    for (int i = 0; i < 3; ++i) {
      triangle.v[i] = vertices[triangle.v[i]];
      triangle.n[i] = mapped(triangles, triangle.n[i]);
    }
    to.tin.triangles.push_back(triangle);
    to.tin.classes.push_back(tile.tin.classes[t]);
    CarriedState state = tile.carried[t];
    state.record = mapped(records, state.record);
    if (samples == PushedSamples::kAll) {
      keep_all_samples(tile, t, state, to);
    } else {
      keep_carried_samples(tile, t, scratch, state, to);
    }
    to.carried.push_back(state);
  }
  for (Vertex& v : to.tin.vertices) {
    v.triangle = triangles[v.triangle];
  }
  pushed.records = std::move(tile.records);
  pushed.stars = std::move(tile.stars);
  tile = {};
  return pushed;
}

namespace {

/// Makes room once: arrays that grow step by step are copied, and their pages touched, several
/// times.
void reserve_for(const std::vector<Tile>& parts, Tile& to) {
  std::size_t triangles = 0;
  std::size_t records = 0;
  std::size_t samples = 0;
  for (const Tile& part : parts) {
    triangles += part.tin.triangles.size();
    records += part.records.size();
    samples += part.samples.used();
  }
  to.tin.triangles.reserve(triangles);
  to.tin.classes.reserve(triangles);
  to.carried.reserve(triangles);
  to.records.reserve(records);
  to.samples.reserve(samples + samples / 4);  // the first collapses take further lists
}

}  // namespace

Tile join_tiles(std::vector<Tile>&& parts, const TileTree& tree, const TileId& parent) {
  Tile to;
  to.units = parts.front().units;
  to.samples_fill_grid = parts.front().samples_fill_grid;
  const std::vector<Renumbering> place = join_vertices(parts, to);
  reserve_for(parts, to);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Tile& part = parts[p];
    to.has_voids |= part.has_voids;
    const auto first_triangle = static_cast<TriangleId>(to.tin.triangles.size());
    const auto first_record = static_cast<std::uint32_t>(to.records.size());
    for (TriangleId t = 0; t < part.tin.triangles.size(); ++t) {
      Triangle triangle = part.tin.triangles[t];
      for (int i = 0; i < 3; ++i) {
        triangle.v[i] = place[p][triangle.v[i]];
        triangle.n[i] = triangle.n[i] == kNone ? kNone : triangle.n[i] + first_triangle;
      }
      CarriedState state = part.carried[t];
      state.record = state.record == kNone ? kNone : state.record + first_record;
      const auto samples = part.samples.samples(part.carried[t].samples);
      state.samples = to.samples.take(static_cast<std::uint32_t>(samples.size()));
      std::copy(samples.begin(), samples.end(), to.samples.samples(state.samples).begin());
      to.tin.triangles.push_back(triangle);
      to.tin.classes.push_back(part.tin.classes[t]);
      to.carried.push_back(state);
    }
    to.records.insert(to.records.end(), part.records.begin(), part.records.end());
    part = {};
  }
  link_sides(to.tin);
  settle_vertices(to);
  lock_seams(to, tree, parent);
  return to;
}

namespace {

/// Over points and TINs: the triangles of a vertex are not all in the tile exactly when it has an
/// edge with nothing beyond that is not on the hull.
void lock_open_edges(Tile& tile, const ConvexHull& hull) {
  const Tin& tin = tile.tin;
  for (VertexState& v : tile.vertex_state) {
    v.locked = false;
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const VertexId a = tin.triangles[t].v[next_corner(i)];
      const VertexId b = tin.triangles[t].v[previous_corner(i)];
      if (tin.triangles[t].n[i] == kNone && !hull.has_on_border(tin.position(a), tin.position(b))) {
        tile.vertex_state[a].locked = tile.vertex_state[b].locked = true;
      }
    }
  }
}

}  // namespace

void lock_seams(Tile& tile, const TileTree& tree, const TileId& id) {
  if (tree.hull() != nullptr) {
    lock_open_edges(tile, *tree.hull());
    return;
  }
  for (VertexId v = 0; v < tile.tin.vertices.size(); ++v) {
    const GridPoint p = tile.tin.position(v);
    tile.vertex_state[v].locked = tree.on_seam(id, p.x, p.y);
  }
}

}  // namespace ptin
