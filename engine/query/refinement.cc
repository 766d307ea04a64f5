// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refinement.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"
#include "engine/mesh/split.h"
#include "engine/mesh/star.h"

namespace ptin {

namespace {

constexpr std::size_t kLookAhead = 16;       // Records ahead whose hash slots are fetched.
constexpr std::size_t kStopInterval = 4096;  // Splits between two looks at the stop token.

/// Where each rank's records begin when sorted by falling rank: the counting sort (paper, section
/// 4).
class RankOrder {
 public:
  explicit RankOrder(std::span<const PendingSplit> splits, std::uint32_t first) {
    for (const PendingSplit& s : splits) {
      largest_ = std::max(largest_, s.rank);
    }
    next_.assign(std::size_t{largest_} + 2, 0);
    for (const PendingSplit& s : splits) {
      ++next_[largest_ - s.rank + 1];
    }
    next_[0] = first;
    for (std::size_t i = 1; i < next_.size(); ++i) {
      next_[i] += next_[i - 1];
    }
  }
  /// The place of the next record of this rank.
  std::uint32_t take(std::uint16_t rank) noexcept { return next_[largest_ - rank]++; }

 private:
  std::uint16_t largest_ = 0;
  std::vector<std::uint32_t> next_;
};

[[noreturn]] void throw_refused(const PendingSplit& s, const std::string& why,
                                const QueryContext& context) {
  const GridPoint u = point_of(s.u);
  throw Error(ErrorCode::corruption,
              "page " + std::to_string(s.page) + ", record of vertex (" + std::to_string(u.x) +
                  ", " + std::to_string(u.y) + "): " + why +
                  "; run verify, and build the file again",
              context.file());
}

SplitSite site_of(VertexId u, VertexId w, VertexId vl, VertexId vr, std::uint32_t flags) noexcept {
  const auto class_of = [flags](std::uint32_t bit) {
    return (flags & bit) != 0 ? TriangleClass::kVoid : TriangleClass::kSurface;
  };
  return {u,
          w,
          vl,
          vr,
          (flags & VertexSplit::kNoLeft) == 0,
          (flags & VertexSplit::kNoRight) == 0,
          class_of(VertexSplit::kLeftVoid),
          class_of(VertexSplit::kRightVoid)};
}

bool has_heights(const Tin& tin, VertexId a, VertexId b, VertexId c) noexcept {
  return (tin.has_height[a] & tin.has_height[b] & tin.has_height[c]) != 0;
}

/// Invariant I5 around a new vertex: only a vertex with a height stands in surface triangles.
bool classes_fit(const Tin& tin, const SplitSite& s, const SplitResult& made) {
  if (tin.has_height[s.u] == 0) {
    Star star;
    walk_star(tin, s.u, star);
    return std::all_of(star.triangles.begin(), star.triangles.end(),
                       [&](TriangleId t) { return tin.classes[t] == TriangleClass::kVoid; });
  }
  const bool left = made.left == kNone || s.left_class == TriangleClass::kVoid ||
                    has_heights(tin, s.u, s.w, s.vl);
  const bool right = made.right == kNone || s.right_class == TriangleClass::kVoid ||
                     has_heights(tin, s.u, s.w, s.vr);
  return left && right;
}

void fetch_triangle(const Tin& tin, VertexId w) noexcept {
  const TriangleId t = tin.vertices[w].triangle;
  if (t != kNone) {
    __builtin_prefetch(&tin.triangles[t]);
  }
}

}  // namespace

std::uint64_t refinement_bytes(std::uint64_t records) noexcept {
  constexpr std::uint64_t kVertexBytes = sizeof(Vertex) + sizeof(std::uint8_t);
  constexpr std::uint64_t kTriangleBytes = sizeof(Triangle) + sizeof(TriangleClass);
  constexpr std::uint64_t kRecordBytes =
      sizeof(PendingSplit) + 4 * sizeof(std::uint32_t) + kVertexBytes + 2 * kTriangleBytes;
  return records * kRecordBytes + KeyTable::bytes_for(records);
}

Refinement::Refinement(const Tin& t0, bool track_pages) : tin_(t0), track_pages_(track_pages) {
  ids_.reserve(tin_.vertices.size());
  for (VertexId v = 0; v < tin_.vertices.size(); ++v) {
    ids_.insert(key_of(tin_.position(v)), v);
  }
  if (track_pages_) {
    vertex_pages_.assign(tin_.vertices.size(), kNone);
    triangle_pages_.assign(tin_.triangles.size(), kNone);
  }
}

void Refinement::apply(std::span<const PendingSplit> splits, QueryContext& context) {
  reserve(splits.size(), context);
  const auto first = static_cast<VertexId>(tin_.vertices.size());
  add_vertices(splits, context);
  const std::vector<Resolved> resolved = resolve(splits, context);
  for (std::size_t i = 0; i < resolved.size(); ++i) {
    if (i % kStopInterval == 0) {
      context.check_stop();
    }
    if (i + kLookAhead < resolved.size()) {
      __builtin_prefetch(&tin_.vertices[resolved[i + kLookAhead].w]);
      fetch_triangle(tin_, resolved[i + kLookAhead / 2].w);
    }
    apply_one(static_cast<VertexId>(first + i), resolved[i], splits, context);
  }
  context.cost.records_applied += resolved.size();
}

void Refinement::reserve(std::size_t splits, const QueryContext& context) {
  const std::size_t vertices = tin_.vertices.size() + splits;
  const std::size_t triangles = tin_.triangles.size() + 2 * splits;
  if (triangles >= kNone) {
    throw Error(ErrorCode::resource_exhausted,
                "the answer has more triangles than one mesh can number (2^32 - 1): ask for less, "
                "or use export",
                context.file());
  }
  tin_.vertices.reserve(vertices);
  tin_.has_height.reserve(vertices);
  tin_.triangles.reserve(triangles);
  tin_.classes.reserve(triangles);
  ids_.reserve(vertices);
}

/// Gives every new vertex its place in the sorted order as its index, so that neighbours in that
/// order lie near in memory.
void Refinement::add_vertices(std::span<const PendingSplit> splits, const QueryContext& context) {
  RankOrder order(splits, static_cast<std::uint32_t>(tin_.vertices.size()));
  tin_.vertices.resize(tin_.vertices.size() + splits.size());
  tin_.has_height.resize(tin_.vertices.size());
  if (track_pages_) {
    vertex_pages_.resize(tin_.vertices.size());
  }
  for (std::size_t i = 0; i < splits.size(); ++i) {
    if (i % kStopInterval == 0) {
      context.check_stop();
    }
    if (i + kLookAhead < splits.size()) {
      ids_.prefetch(splits[i + kLookAhead].u);
    }
    const PendingSplit& s = splits[i];
    const VertexId u = order.take(s.rank);
    if (!ids_.insert(s.u, u)) {
      throw_refused(s, "its vertex is in the mesh already", context);
    }
    tin_.vertices[u] = {point_of(s.u), s.height, kNone};
    if (track_pages_) {
      vertex_pages_[u] = s.page;
    }
    tin_.has_height[u] = (s.flags & VertexSplit::kVertexVoid) == 0 ? 1 : 0;
  }
}

/// All references of all splits at once, in the order of the file, before the first split is made:
/// look-ups do not wait for one another. A reference to a vertex that comes later in the order is
/// found here and refused by apply_one().
std::vector<Refinement::Resolved> Refinement::resolve(std::span<const PendingSplit> splits,
                                                      const QueryContext& context) const {
  RankOrder order(splits, 0);
  std::vector<Resolved> resolved(splits.size());
  for (std::size_t i = 0; i < splits.size(); ++i) {
    if (i % kStopInterval == 0) {
      context.check_stop();
    }
    if (i + kLookAhead < splits.size()) {
      const PendingSplit& ahead = splits[i + kLookAhead];
      ids_.prefetch(ahead.w);
      ids_.prefetch(ahead.vl);
      ids_.prefetch(ahead.vr);
    }
    const PendingSplit& s = splits[i];
    const Resolved r{ids_.find(s.w), ids_.find(s.vl), ids_.find(s.vr), s.flags};
    if (r.w == KeyTable::kAbsent || r.vl == KeyTable::kAbsent || r.vr == KeyTable::kAbsent) {
      throw_refused(s, "it names a vertex that no retrieved record makes", context);
    }
    resolved[order.take(s.rank)] = r;
  }
  return resolved;
}

void Refinement::apply_one(VertexId u, const Resolved& s, std::span<const PendingSplit> splits,
                           const QueryContext& context) {
  const SplitSite site = site_of(u, s.w, s.vl, s.vr, s.flags);
  const bool w_is_there = tin_.vertices[s.w].triangle != kNone;
  const SplitResult made = w_is_there ? split(tin_, site) : SplitResult{};
  if (!made.applied || !classes_fit(tin_, site, made)) [[unlikely]] {
    const VertexKey key = key_of(tin_.position(u));
    const auto refused = std::find_if(splits.begin(), splits.end(),
                                      [&](const PendingSplit& p) { return p.u == key; });
    throw_refused(*refused,
                  made.applied ? "its classes do not fit its heights" : "it does not fit the mesh",
                  context);
  }
  if (track_pages_) {
    triangle_pages_.resize(tin_.triangles.size());
    Star star;
    walk_star(tin_, u, star);
    for (const TriangleId t : star.triangles) {
      triangle_pages_[t] = vertex_pages_[u];
    }
  }
}

}  // namespace ptin
