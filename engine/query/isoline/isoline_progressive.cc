// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_progressive.h"

#include <algorithm>
#include <utility>

#include "engine/check.h"
#include "engine/error.h"
#include "engine/query/isoline/isoline_trace.h"

namespace ptin {

ProgressiveIsolines::ProgressiveIsolines(const Tin& tin, LevelSet levels,
                                         const HeightEncoding& heights, const AffineMap& map,
                                         QueryContext context)
    : levels_(std::move(levels)), heights_(heights), map_(map), context_(std::move(context)) {
  restart(tin);
}

/// Makes room for `more` elements. Asks the context before it takes the memory, the old array
/// included, which stays while elements are moved. Room at least doubles, so that moving costs O(1)
/// an element.
template <typename T>
void ProgressiveIsolines::make_room(std::vector<T>& array, std::uint64_t more) const {
  const std::uint64_t needed = array.size() + more;
  if (needed <= array.capacity()) {
    return;
  }
  const std::uint64_t room = std::max<std::uint64_t>(needed, 2 * array.capacity());
  context_.admit(bytes() + room * sizeof(T));
  array.reserve(room);
}

void ProgressiveIsolines::refuse_more_pieces() const {
  throw Error(ErrorCode::resource_exhausted,
              "the isolines have more pieces than 32 bits number: ask for fewer levels or a larger "
              "tolerance",
              context_.file());
}

void ProgressiveIsolines::make_room_for_pieces(std::uint64_t pieces) {
  const std::uint64_t fresh = pieces - std::min<std::uint64_t>(pieces, free_.size());
  if (slots_.size() + fresh >= kNone) {
    refuse_more_pieces();
  }
  make_room(slots_, fresh);
  make_room(free_, slots_.size() + fresh - free_.size());
}

void ProgressiveIsolines::restart(const Tin& tin) {
  bands_.clear();
  slots_.clear();
  free_.clear();
  by_level_.clear();
  level_capacity_ = 0;
  context_.admit(bytes() + levels_.size() * sizeof(std::vector<std::uint32_t>));
  by_level_.resize(levels_.size());
  first_.clear();
  make_room(first_, tin.triangles.size());
  first_.assign(tin.triangles.size(), kNone);
  add_bands(tin);
  std::uint64_t pieces = 0;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    context_.check_stop();
    pieces += tin.is_alive(t) ? pieces_in(tin, t) : 0;
  }
  make_room_for_pieces(pieces);
  IsolineChange all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    context_.check_stop();
    if (tin.is_alive(t)) {
      add_pieces(tin, t, all);
    }
  }
}

IsolineChange ProgressiveIsolines::advance(const Tin& tin) {
  PTIN_CHECK(tin.vertices.size() >= bands_.size() && tin.triangles.size() >= first_.size());
  IsolineChange change;
  const auto known = static_cast<VertexId>(bands_.size());
  add_bands(tin);
  make_room(first_, tin.triangles.size() - first_.size());
  first_.resize(tin.triangles.size(), kNone);
  for (VertexId u = known; u < tin.vertices.size(); ++u) {
    context_.check_stop();
    ++change.splits;
    walk_star(tin, u, star_);
    for (const TriangleId t : star_.triangles) {
      const auto& v = tin.triangles[t].v;
      if (std::max({v[0], v[1], v[2]}) != u) {
        continue;  // has a newer corner, and is taken with that one
      }
      ++change.triangles;
      remove_pieces(t, change);
      add_pieces(tin, t, change);
    }
  }
  return change;
}

void ProgressiveIsolines::add_bands(const Tin& tin) {
  make_room(bands_, tin.vertices.size() - bands_.size());
  for (std::size_t v = bands_.size(); v < tin.vertices.size(); ++v) {
    bands_.push_back(levels_.band_of(heights_.code(tin.vertices[v].height)));
  }
}

void ProgressiveIsolines::remove_pieces(TriangleId t, IsolineChange& change) {
  for (std::uint32_t s = std::exchange(first_[t], kNone); s != kNone; s = slots_[s].next) {
    std::vector<std::uint32_t>& level = by_level_[slots_[s].level];
    const std::uint32_t last = level.back();
    level[slots_[s].place] = last;
    slots_[last].place = slots_[s].place;
    level.pop_back();
    free_.push_back(s);  // free_ has room for all slots
    ++change.removed;
  }
}

std::uint32_t ProgressiveIsolines::pieces_in(const Tin& tin, TriangleId t) const noexcept {
  const auto& v = tin.triangles[t].v;
  const auto [low, high] = std::minmax({bands_[v[0]], bands_[v[1]], bands_[v[2]]});
  return tin.classes[t] == TriangleClass::kSurface ? high - low : 0;
}

void ProgressiveIsolines::add_pieces(const Tin& tin, TriangleId t, IsolineChange& change) {
  if (tin.classes[t] != TriangleClass::kSurface) {
    return;
  }
  const auto& v = tin.triangles[t].v;
  const auto [low, high] = std::minmax({bands_[v[0]], bands_[v[1]], bands_[v[2]]});
  make_room_for_pieces(high - low);
  for (std::uint32_t level = low; level < high; ++level) {
    if (free_.empty()) {
      free_.push_back(static_cast<std::uint32_t>(slots_.size()));
      slots_.emplace_back();
    }
    const std::uint32_t s = free_.back();
    free_.pop_back();
    slots_[s] = {t, level, first_[t], static_cast<std::uint32_t>(by_level_[level].size())};
    first_[t] = s;
    const std::size_t room = by_level_[level].capacity();
    make_room(by_level_[level], 1);
    level_capacity_ += by_level_[level].capacity() - room;
    by_level_[level].push_back(s);
    ++change.added;
  }
}

std::uint64_t ProgressiveIsolines::bytes() const noexcept {
  return (bands_.capacity() + first_.capacity() + free_.capacity() + level_capacity_) *
             sizeof(std::uint32_t) +
         slots_.capacity() * sizeof(Slot) + by_level_.size() * sizeof(std::vector<std::uint32_t>);
}

Isolines ProgressiveIsolines::lines(const Tin& tin, const QueryContext& context) const {
  PTIN_CHECK(tin.vertices.size() == bands_.size() && tin.triangles.size() == first_.size());
  // At most a chain and two points a piece, and a line a piece.
  const std::uint64_t point_bytes = pieces() * 2 * sizeof(MapPoint);
  context.admit(bytes() + ChainSet::bytes_for(pieces(), 2 * pieces()) + point_bytes +
                2 * pieces() * sizeof(IsolinePiece));
  Isolines result{PointStore(point_bytes, {})};
  LineTracer tracer(levels_, heights_, map_, context);
  tracer.begin({}, UINT64_MAX);
  for (TriangleId t = 0; t < first_.size(); ++t) {
    if (first_[t] != kNone && !tracer.add(living_triangle(tin, t))) {
      refuse_more_pieces();
    }
  }
  const TracedPieces& traced = tracer.join();
  result.pieces_ = traced.pieces;
  result.points_.add(traced.points);
  result.lines_ = join_pieces(result.pieces_, context);
  drop_single_points(result.lines_, result.pieces_, result.points_);
  result.levels_ = levels_.heights();
  result.crossed.segments = pieces();
  result.tiles = 1;
  return result;
}

}  // namespace ptin
