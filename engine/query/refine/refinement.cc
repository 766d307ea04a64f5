// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/refinement.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/error.h"
#include "engine/large_array.h"
#include "engine/mesh/split.h"
#include "engine/mesh/star.h"
#include "engine/prefetch.h"
#include "engine/query/refine/apply_order.h"
#include "engine/query/refine/split_site.h"

namespace ptin {

namespace {

bool has_heights(const Tin& tin, VertexId a, VertexId b, VertexId c) noexcept {
  return (tin.has_height[a] & tin.has_height[b] & tin.has_height[c]) != 0;
}

/// Invariant I5 around a new vertex: only a vertex with a height stands in surface triangles. To be
/// asked where a vertex of the mesh has none.
bool classes_fit(const Tin& tin, const SplitSite& s) {
  if (tin.has_height[s.u] == 0) {
    Star star;
    walk_star(tin, s.u, star);
    return std::all_of(star.triangles.begin(), star.triangles.end(),
                       [&](TriangleId t) { return tin.classes[t] == TriangleClass::kVoid; });
  }
  const bool left =
      !s.has_left || s.left_class == TriangleClass::kVoid || has_heights(tin, s.u, s.w, s.vl);
  const bool right =
      !s.has_right || s.right_class == TriangleClass::kVoid || has_heights(tin, s.u, s.w, s.vr);
  return left && right;
}

[[noreturn]] void throw_too_many(const QueryContext& context) {
  throw Error(ErrorCode::resource_exhausted,
              "the answer has more triangles than one mesh can number (2^32 - 1): ask for less, "
              "or use export",
              context.file());
}

[[noreturn]] void throw_not_made(const PendingSplit& s, const QueryContext& context) {
  throw_refused(s, "it names a vertex that no retrieved record makes before it", context);
}

/// Refuses splits that 32 bits cannot number.
void refuse_too_many(std::span<const PendingSplit> splits, const QueryContext& context) {
  if (splits.size() >= kNone) {
    throw_too_many(context);
  }
}

/// Fetches into the caches, ahead of the splits, what they will touch: the record, its slots in the
/// table of vertices, w, whose key the table looks at, the triangle known of w, and what lies around
/// that.
/// Looks at the mesh as it is now: where the mesh changes before the split comes, the split misses
/// the cache, and nothing else happens.
class StarFetcher {
 public:
  explicit StarFetcher(const Tin& tin) : tin_(tin) {}

  /// Steps of the pipeline: how many splits after the fetch of its record a split reaches each of
  /// them. The last one applies the split.
  static constexpr std::size_t kSlots = 8, kVertex = 16, kEnter = 24, kNeighbours = 32, kApply = 40;

  static void fetch_record(const PendingSplit& s) noexcept {
    const auto* const bytes = reinterpret_cast<const char*>(&s);  // may lie across two lines
    prefetch(bytes);
    prefetch(bytes + sizeof s - 1);
  }
  static void fetch_slots(const PendingSplit& s, const VertexTable& ids) noexcept {
    ids.prefetch(s.u);
    ids.prefetch(s.w);
  }
  void fetch_vertex(const PendingSplit& s, const VertexTable& ids) const noexcept {
    const VertexId w = ids.guess(s.w);
    prefetch(&tin_.vertices[w == kNone ? 0 : w]);
  }
  void fetch_triangle(VertexId w) const noexcept { fetch(tin_.vertices[w].triangle); }
  // Fetches the neighbour and the corner that are not around w too: finding out which they are would
  // cost more.
  void fetch_neighbours(VertexId w) const noexcept {
    const TriangleId t = tin_.vertices[w].triangle;
    if (t == kNone) {
      return;
    }
    for (const TriangleId n : tin_.triangles[t].n) {
      fetch(n);
    }
    for (const VertexId v : tin_.triangles[t].v) {
      prefetch(&tin_.vertices[v]);
    }
  }

 private:
  void fetch(TriangleId t) const noexcept {
    // For kNone it fetches triangle 0.
    prefetch(&tin_.triangles[t == kNone ? 0 : t]);
  }

  const Tin& tin_;
};

}  // namespace

std::uint64_t bytes_of(const Tin& tin) noexcept {
  return tin.vertices.size() * (sizeof(Vertex) + 1) +
         tin.triangles.size() * (sizeof(Triangle) + 1) +
         VertexTable::bytes_for(tin.vertices.size());
}

Refinement::Refinement(const Tin& t0, bool track_pages) : tin_(t0), track_pages_(track_pages) {
  has_void_vertex_ =
      std::find(tin_.has_height.begin(), tin_.has_height.end(), 0) != tin_.has_height.end();
  ids_.reset(tin_.vertices.capacity());
  for (VertexId v = 0; v < tin_.vertices.size(); ++v) {
    ids_.insert(tin_, v);
  }
  if (track_pages_) {
    vertex_pages_.assign(tin_.vertices.size(), kNone);
    triangle_pages_.assign(tin_.triangles.size(), kNone);
  }
}

/// Puts the new vertex in its place, in no triangle yet, and looks up the vertex w of its split. One
/// word is returned: a pair would be stored in parts, and loaded whole as soon as that is done.
[[gnu::always_inline]] inline VertexId Refinement::enter(const PendingSplit& s, VertexId u,
                                                         const QueryContext& context) {
  tin_.vertices[u] = {point_of(s.u), s.height, kNone};
  const bool is_void = (s.flags & VertexSplit::kVertexVoid) != 0;
  tin_.has_height[u] = is_void ? 0 : 1;
  has_void_vertex_ |= is_void;
  if (!ids_.insert(tin_, u)) [[unlikely]] {
    throw_refused(s, "its vertex is in the mesh already", context);
  }
  if (track_pages_) {
    vertex_pages_[u] = s.page;
  }
  const VertexId w = ids_.find(tin_, s.w);
  if (w == kNone) [[unlikely]] {
    throw_not_made(s, context);
  }
  return w;
}

// Inlined, as enter(): to save and restore the registers takes forty instructions a split.
[[gnu::always_inline]] inline void Refinement::apply_one(const PendingSplit& s, const Resolved& r,
                                                         const Batch& batch,
                                                         const QueryContext& context) {
  SplitSite site = site_of(r.u, r.w, kNone, kNone, s.flags);
  const bool w_is_there = tin_.vertices[r.w].triangle != kNone;
  // A record with one side (or, damaged, with none) does not use the other place, which may not
  // exist.
  const TriangleId left = triangle_place(batch, r.triangle);
  const TriangleId right = triangle_place(batch, r.triangle + (site.has_left ? 1 : 0));
  if (!w_is_there || !split_into(tin_, site, {s.vl, s.vr}, left, right)) [[unlikely]] {
    if (ids_.find(tin_, s.vl) == kNone || ids_.find(tin_, s.vr) == kNone) {
      throw_not_made(s, context);
    }
    throw_refused(s, "it does not fit the mesh", context);
  }
  if (has_void_vertex_ && !classes_fit(tin_, site)) [[unlikely]] {
    throw_refused(s, "its classes do not fit its heights", context);
  }
  if (track_pages_) {
    Star star;
    walk_star(tin_, r.u, star);
    for (const TriangleId t : star.triangles) {
      triangle_pages_[t] = vertex_pages_[r.u];
    }
  }
}

void Refinement::apply(std::span<const PendingSplit> splits, QueryContext& context) {
  static constexpr std::size_t kFew = 4096;  // splits of a mesh that stays in the caches anyway
  refuse_too_many(splits, context);
  order_ = order_of(splits);
  const Batch batch = reserve(splits, context);
  if (splits.size() < kFew) {
    apply_one_by_one(splits, batch, context);
  } else {
    apply_in_pipeline(splits, batch, context);
  }
  forget_places(batch);
  context.cost.records_applied += splits.size();
}

void Refinement::apply_one_by_one(std::span<const PendingSplit> splits, const Batch& batch,
                                  const QueryContext& context) {
  context.check_stop();
  std::uint32_t triangles = 0;
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const PendingSplit& s = splits[order_[i]];
    const VertexId u = vertex_place(batch, i);
    const Resolved r{u, enter(s, u, context), triangles};
    triangles += triangles_of(s.flags);
    apply_one(s, r, batch, context);
  }
}

/// While one split is applied, the splits behind it are looked up and fetched. The w of a split is
/// looked up after all splits before it were entered, so it is found.
void Refinement::apply_in_pipeline(std::span<const PendingSplit> splits, const Batch& batch,
                                   const QueryContext& context) {
  const StarFetcher fetcher(tin_);
  using F = StarFetcher;
  constexpr std::size_t kRing = 32;
  static_assert(F::kApply - F::kEnter < kRing);
  std::array<Resolved, kRing> ring;
  std::uint32_t triangles = 0;
  const std::size_t count = splits.size();
  for (std::size_t step = 0; step < count + F::kApply; ++step) {
    if (step % kStopInterval == 0) {
      context.check_stop();
    }
    // The split that is `distance` behind the step. Before the first split it wraps around, to a
    // number beyond `count`.
    const auto at = [step](std::size_t distance) { return step - distance; };
    if (step < count) {
      F::fetch_record(splits[order_[step]]);
    }
    if (const std::size_t i = at(F::kSlots); i < count) {
      F::fetch_slots(splits[order_[i]], ids_);
    }
    if (const std::size_t i = at(F::kVertex); i < count) {
      fetcher.fetch_vertex(splits[order_[i]], ids_);
    }
    if (const std::size_t i = at(F::kEnter); i < count) {
      Resolved& r = ring[i % kRing];
      const PendingSplit& s = splits[order_[i]];
      r.u = vertex_place(batch, i);
      r.w = enter(s, r.u, context);
      r.triangle = triangles;
      triangles += triangles_of(s.flags);
      fetcher.fetch_triangle(r.w);
    }
    if (const std::size_t i = at(F::kNeighbours); i < count) {
      fetcher.fetch_neighbours(ring[i % kRing].w);
    }
    if (const std::size_t i = at(F::kApply); i < count) {
      apply_one(splits[order_[i]], ring[i % kRing], batch, context);
    }
  }
}

/// Makes room for the vertices and triangles to come. A new triangle counts as removed until its
/// split is made. A mesh that grows a second time grows by half at least, so that many small
/// batches do not copy it each time.
Refinement::Batch Refinement::reserve(std::span<const PendingSplit> splits,
                                      const QueryContext& context) {
  Batch batch{splits.size(), 0, static_cast<VertexId>(tin_.vertices.size()),
              static_cast<TriangleId>(tin_.triangles.size())};
  for (const PendingSplit& s : splits) {
    batch.triangles += triangles_of(s.flags);
  }
  const std::size_t vertices =
      tin_.vertices.size() + batch.vertices - std::min(batch.vertices, free_vertices_.size());
  const std::size_t triangles =
      tin_.triangles.size() + batch.triangles - std::min(batch.triangles, free_triangles_.size());
  if (triangles >= kNone || vertices >= kNone) {
    throw_too_many(context);
  }
  const auto grown = [](std::size_t wanted, std::size_t capacity) {
    return wanted > capacity ? std::max(wanted, capacity + capacity / 2) : capacity;
  };
  reserve_large(tin_.vertices, grown(vertices, tin_.vertices.capacity()));
  reserve_large(tin_.triangles, grown(triangles, tin_.triangles.capacity()));
  ids_.reserve(tin_, tin_.vertices.capacity());
  tin_.vertices.resize(vertices);
  tin_.has_height.resize(vertices);
  tin_.triangles.resize(triangles, {{kNone, kNone, kNone}, {kNone, kNone, kNone}});
  tin_.classes.resize(triangles);
  if (track_pages_) {
    vertex_pages_.resize(vertices, kNone);
    triangle_pages_.resize(triangles, kNone);
  }
  return batch;
}

/// Takes the places that the batch has filled off the lists of free places.
void Refinement::forget_places(const Batch& batch) {
  const auto drop = [](auto& free, std::size_t taken) {
    free.erase(free.begin(),
               free.begin() + static_cast<std::ptrdiff_t>(std::min(taken, free.size())));
  };
  drop(free_vertices_, batch.vertices);
  drop(free_triangles_, batch.triangles);
}

}  // namespace ptin
