// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_trace.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "engine/prefetch.h"
#include "storage/page_columns.h"

namespace ptin {

namespace {

/// How far ahead of a look-up its slot is fetched.
constexpr std::size_t kAhead = 16;

bool is_in_tile(const GridBox& tile, GridPoint a, GridPoint b, GridPoint c) noexcept {
  return contains(tile, point_of(std::min({key_of(a), key_of(b), key_of(c)})));
}

}  // namespace

void LineTracer::begin(const TraceScope& scope, std::uint64_t most_bytes) {
  scope_ = scope;
  most_bytes_ = most_bytes;
  bytes_wanted_ = 0;
  counts_ = {};
  chains_.clear();
  points_.clear();
  vertices_.reset(0);
}

LineTracer::Corner LineTracer::corner_of(GridPoint position, HeightBits height) const noexcept {
  return {position, ordered_height(height, heights_.type)};
}

bool LineTracer::add(const LivingStars& stars) {
  const LivingCorner* first = stars.corners.data();
  for (std::size_t i = 0; i < stars.stars.size(); ++i) {
    const LivingStar& star = stars.stars.data()[i];
    const LivingCorner* const last = stars.corners.data() + star.corner_end;
    if (star.has_height && !add_star(star, {first, last})) {
      return false;
    }
    first = last;
  }
  return true;
}

bool LineTracer::add(const LivingTriangle& t) {
  if (t.is_void) {
    return true;
  }
  LivingStar star;
  star.u = t.corner[0].position;
  star.height = t.corner[0].height;
  const std::array<LivingCorner, 2> ring{
      LivingCorner{t.corner[1].position, t.corner[1].height, LivingCorner::kLives},
      LivingCorner{t.corner[2].position, t.corner[2].height, 0}};
  return add_star(star, ring);
}

bool LineTracer::add(const Tin& tin, TriangleId t) {
  LivingTriangle triangle;
  triangle.is_void = tin.classes[t] == TriangleClass::kVoid;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& v = tin.vertices[tin.triangles[t].v[i]];
    triangle.corner[i] = {v.position, v.height, true};
  }
  return add(triangle);
}

/// Adds the triangles of a star whose centre has a height.
bool LineTracer::add_star(const LivingStar& star, std::span<const LivingCorner> ring) {
  centre_ = corner_of(star.u, star.height);
  std::uint32_t low = centre_.height;
  std::uint32_t high = centre_.height;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    corners_[k] = corner_of(ring[k].position, ring[k].height);
    if ((ring[k].flags & LivingCorner::kNoHeight) == 0) {
      low = std::min(low, corners_[k].height);
      high = std::max(high, corners_[k].height);
    }
  }
  std::uint32_t level = levels_.band_of(heights_.code(height_of_ordered(low, heights_.type)));
  if (level == levels_.size() || levels_.least_above(level) > high) {
    return true;
  }
  find_wanted(star, ring);
  for (; level < levels_.size() && levels_.least_above(level) <= high; ++level) {
    if (!has_room(ring.size())) {
      return false;
    }
    trace_level(level, ring.size() - 1);
  }
  return true;
}

/// Finds the triangles of a star that are traced.
void LineTracer::find_wanted(const LivingStar& star, std::span<const LivingCorner> ring) {
  for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
    const GridPoint a = ring[k].position;
    const GridPoint b = ring[k + 1].position;
    is_wanted_[k] =
        (ring[k].flags & (LivingCorner::kLives | LivingCorner::kVoid)) == LivingCorner::kLives &&
        (scope_.region == nullptr || scope_.region->meets(star.u, a, b));
  }
  if (scope_.counts_vertices) {
    count_vertices(ring.size() - 1);
  }
  for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
    is_wanted_[k] =
        is_wanted_[k] && is_in_tile(scope_.tile, star.u, ring[k].position, ring[k + 1].position);
    is_crossed_[k] = false;
  }
}

/// Counts the corners in the tile of the triangles that a level crosses. All such triangles around a
/// corner in the tile come, since they meet the tile.
void LineTracer::count_vertices(std::size_t triangles) {
  vertices_.reserve(std::bit_ceil(vertices_.size() + 3 * triangles));
  for (std::size_t k = 0; k < triangles; ++k) {
    const auto [low, high] =
        std::minmax({centre_.height, corners_[k].height, corners_[k + 1].height});
    const auto band = [&](std::uint32_t height) {
      return levels_.band_of(heights_.code(height_of_ordered(height, heights_.type)));
    };
    if (!is_wanted_[k] || band(low) == band(high)) {
      continue;
    }
    for (const GridPoint p : {centre_.position, corners_[k].position, corners_[k + 1].position}) {
      if (contains(scope_.tile, p)) {
        static_cast<void>(vertices_.insert(key_of(p), 0));
      }
    }
  }
  counts_.vertices = vertices_.size();
}

/// Follows a level through the triangles of the star at hand. Where the centre lies below the level
/// lines go counter-clockwise around it, else clockwise: from a triangle over a spoke to the next.
void LineTracer::trace_level(std::uint32_t level, std::size_t triangles) {
  const std::uint64_t least = levels_.least_above(level);
  const bool is_centre_above = centre_.height >= least;
  bool is_open = false;  // the last chain ends on the spoke before the next triangle
  for (std::size_t n = 0; n < triangles; ++n) {
    const std::size_t k = is_centre_above ? triangles - 1 - n : n;
    const Corner& a = corners_[k];
    const Corner& b = corners_[k + 1];
    const bool is_a_above = a.height >= least;
    const bool is_b_above = b.height >= least;
    if (!is_wanted_[k] || (is_a_above == is_centre_above && is_b_above == is_centre_above)) {
      is_open = false;
      continue;
    }
    ++counts_.segments;
    counts_.triangles += is_crossed_[k] ? 0 : 1;
    is_crossed_[k] = true;
    const Corner& before = is_centre_above ? b : a;  // on the spoke by which a line may come
    const Corner& behind = is_centre_above ? a : b;
    if (!is_open) {
      const bool is_spoke = (is_centre_above ? is_b_above : is_a_above) != is_centre_above;
      begin_chain(is_spoke ? spoke(before, is_centre_above, level) : cut(a, b, level), level);
    }
    is_open = (is_centre_above ? is_a_above : is_b_above) != is_centre_above;
    extend_chain(is_open ? spoke(behind, is_centre_above, level) : cut(b, a, level));
  }
}

bool LineTracer::has_room(std::size_t segments) {
  bytes_wanted_ = (chains_.size() + segments) * kBytesAChain +
                  (points_.size() + 2 * segments) * kBytesAPoint +
                  (scope_.counts_vertices ? 2 * KeyTable::bytes_for(2 * vertices_.size()) : 0);
  return bytes_wanted_ <= most_bytes_ && points_.size() + 2 * segments < kNone;
}

/// The cut of the edge from `below` to `above`.
LineTracer::Step LineTracer::cut(const Corner& below, const Corner& above,
                                 std::uint32_t level) const noexcept {
  const auto end_of = [&](const Corner& c) {
    return CutEnd{static_cast<double>(c.position.x), static_cast<double>(c.position.y),
                  heights_.code(height_of_ordered(c.height, heights_.type))};
  };
  const MapPoint p = cut_of(end_of(below), end_of(above), levels_.code(level));
  return {{key_of(below.position), key_of(above.position)}, map_.to_map(p.x, p.y)};
}

/// The cut of the edge between the centre of the star and a corner.
LineTracer::Step LineTracer::spoke(const Corner& corner, bool is_centre_above,
                                   std::uint32_t level) const noexcept {
  return is_centre_above ? cut(corner, centre_, level) : cut(centre_, corner, level);
}

void LineTracer::begin_chain(const Step& step, std::uint32_t level) {
  Chain chain;
  chain.begin = chain.end = chain.smallest = step.edge;
  chain.level = level;
  chain.first = static_cast<std::uint32_t>(points_.size());
  chain.count = 1;
  chain.smallest_at = 0;
  chains_.push_back(chain);
  points_.push_back(step.point);
}

void LineTracer::extend_chain(const Step& step) {
  Chain& chain = chains_.back();
  chain.end = step.edge;
  if (step.edge < chain.smallest) {
    chain.smallest = step.edge;
    chain.smallest_at = chain.count;
  }
  ++chain.count;
  points_.push_back(step.point);
}

std::uint64_t LineTracer::hash_of(const CutEdge& edge, std::uint32_t level) noexcept {
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;  // 2^64 / phi, odd
  const std::uint64_t both =
      (edge.below * kGoldenRatio) ^ std::rotl(edge.above * kGoldenRatio, 29) ^ level;
  return (both ^ (both >> 31)) * kGoldenRatio;
}

void LineTracer::note_begin(std::uint32_t chain) noexcept {
  const std::uint64_t hash = hash_of(chains_[chain].begin, chains_[chain].level);
  std::size_t i = home(hash);
  while (slots_[i].chain != kNone) {
    i = i + 1 == slots_.size() ? 0 : i + 1;
  }
  slots_[i] = {static_cast<std::uint32_t>(hash), chain};
}

/// The chain that begins on an edge at a level, or kNone.
std::uint32_t LineTracer::chain_from(const CutEdge& edge, std::uint32_t level) const noexcept {
  const std::uint64_t hash = hash_of(edge, level);
  for (std::size_t i = home(hash); slots_[i].chain != kNone;
       i = i + 1 == slots_.size() ? 0 : i + 1) {
    const std::uint32_t chain = slots_[i].chain;
    if (slots_[i].tag == static_cast<std::uint32_t>(hash) && chains_[chain].level == level &&
        chains_[chain].begin == edge) {
      return chain;
    }
  }
  return kNone;
}

/// Finds the chain behind each.
void LineTracer::link(const QueryContext& context) {
  slots_.assign(chains_.size() + chains_.size() * 3 / 5 + 2, {});
  const auto fetch = [&](std::size_t i, CutEdge Chain::*edge) {
    if (i < chains_.size()) {
      prefetch(&slots_[home(hash_of(chains_[i].*edge, chains_[i].level))]);
    }
  };
  for (std::uint32_t i = 0; i < chains_.size(); ++i) {
    fetch(i + kAhead, &Chain::begin);
    note_begin(i);
  }
  context.check_stop();
  for (std::uint32_t i = 0; i < chains_.size(); ++i) {
    fetch(i + kAhead, &Chain::end);
    chains_[i].next = chain_from(chains_[i].end, chains_[i].level);
    if (chains_[i].next != kNone) {
      chains_[chains_[i].next].is_next = true;
    }
  }
}

void LineTracer::join(const QueryContext& context, TracedPieces& out) {
  link(context);
  // Rings are what is left once all open lines are taken.
  for (const bool ring : {false, true}) {
    for (std::uint32_t i = 0; i < chains_.size(); ++i) {
      if (i % kStopInterval == 0) {
        context.check_stop();
      }
      if (!chains_[i].is_taken && (ring || !chains_[i].is_next)) {
        take_line(i, ring, out);
      }
    }
  }
}

/// Takes the piece that begins with a chain. A ring has no point for the edge on which that chain
/// begins: it comes back to that edge last.
void LineTracer::take_line(std::uint32_t start, bool ring, TracedPieces& out) {
  IsolinePiece piece;
  piece.level = chains_[start].level;
  piece.ring = ring;
  piece.smallest = {kNoVertexKey, kNoVertexKey};
  line_.clear();
  if (!ring) {
    line_.push_back(points_[chains_[start].first]);
  }
  std::size_t smallest = 0;
  std::uint32_t i = start;
  std::uint32_t last = start;
  do {
    Chain& chain = chains_[i];
    chain.is_taken = true;
    if (chain.smallest < piece.smallest) {
      piece.smallest = chain.smallest;
      smallest = line_.size() + chain.smallest_at;  // one too many: a chain begins where one ends
    }
    const auto first = points_.begin() + chain.first;
    line_.insert(line_.end(), first + 1, first + chain.count);
    last = i;
    i = chain.next;
  } while (i != kNone && i != start);
  if (ring) {
    smallest = smallest == 0 ? line_.size() - 1 : smallest - 1;
    std::rotate(line_.begin(), line_.begin() + static_cast<std::ptrdiff_t>(smallest), line_.end());
    line_.push_back(line_.front());
    smallest = 0;
  } else {
    piece.begin = chains_[start].begin;
    piece.end = chains_[last].end;
    --smallest;
  }
  emit(piece, smallest, out);
}

/// Adds a piece with the points of the line at hand, of which one lies on the smallest edge.
void LineTracer::emit(IsolinePiece piece, std::size_t smallest, TracedPieces& out) {
  std::vector<MapPoint>& points = out.points;
  piece.first = points.size();
  for (std::size_t i = 0; i < line_.size(); ++i) {
    if (i == 0 || points.back() != line_[i]) {
      points.push_back(line_[i]);
    }
    if (i == smallest) {
      piece.smallest_at = static_cast<std::uint32_t>(points.size() - 1 - piece.first);
    }
  }
  piece.count = static_cast<std::uint32_t>(points.size() - piece.first);
  out.pieces.push_back(piece);
}

bool trace_mesh(const Tin& tin, const TraceScope& scope, std::uint64_t most_bytes,
                const QueryContext& context, LineTracer& tracer, TracedPieces& out) {
  tracer.begin(scope, most_bytes);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context.check_stop();
    }
    if (tin.is_alive(t) && !tracer.add(tin, t)) {
      return false;
    }
  }
  tracer.join(context, out);
  return true;
}

}  // namespace ptin
