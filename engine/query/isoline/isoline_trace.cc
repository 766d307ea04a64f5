// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_trace.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "storage/page_columns.h"

namespace ptin {

namespace {

/// Chains that are joined at once: they, and the table of their ends, fit the processor's caches.
constexpr std::size_t kBatch = 2048;

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
  batch_.clear();
  traced_.pieces.clear();
  traced_.points.clear();
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

bool LineTracer::add(const RasterSquare& square) {
  cells_.take(square, heights_);
  if (cells_.least() > cells_.greatest()) {
    return true;
  }
  std::uint32_t level =
      levels_.band_of(heights_.code(height_of_ordered(cells_.least(), heights_.type)));
  if (level == levels_.size() || levels_.least_above(level) > cells_.greatest()) {
    return true;
  }
  // Most squares lie within a tile whole, and need no look at each triangle.
  const bool is_whole =
      scope_.region == nullptr && contains(scope_.tile, square.first) &&
      contains(scope_.tile,
               GridPoint{square.first.x + static_cast<std::int32_t>(square.width) - 1,
                         square.first.y + static_cast<std::int32_t>(square.height) - 1});
  const auto wants = [&](GridPoint a, GridPoint b, GridPoint c) {
    return is_whole || (is_in_tile(scope_.tile, a, b, c) &&
                        (scope_.region == nullptr || scope_.region->meets(a, b, c)));
  };
  for (; level < levels_.size() && levels_.least_above(level) <= cells_.greatest(); ++level) {
    if (batch_.size() >= kBatch) {
      join_batch();
    }
    const std::size_t segments = cells_.find_crossed(levels_.least_above(level), wants);
    if (!has_room(segments)) {
      return false;
    }
    counts_.segments += segments;
    cells_.follow(
        [&](const Corner& below, const Corner& above) {
          batch_.begin(cut(below, above, level), level);
        },
        [&](const Corner& below, const Corner& above) { batch_.extend(cut(below, above, level)); });
  }
  counts_.triangles += cells_.crossed_once();
  return true;
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
    if (batch_.size() >= kBatch) {
      join_batch();
    }
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
      batch_.begin(is_spoke ? spoke(before, is_centre_above, level) : cut(a, b, level), level);
    }
    is_open = (is_centre_above ? is_a_above : is_b_above) != is_centre_above;
    batch_.extend(is_open ? spoke(behind, is_centre_above, level) : cut(b, a, level));
  }
}

bool LineTracer::has_room(std::size_t segments) {
  const std::uint64_t chains = chains_.size() + batch_.size() + segments;
  const std::uint64_t points = chains_.points() + batch_.points() + 2 * segments;
  bytes_wanted_ = ChainSet::bytes_for(chains, points) +
                  2 * traced_.points.size() * sizeof(MapPoint) +
                  (scope_.counts_vertices ? 2 * KeyTable::bytes_for(2 * vertices_.size()) : 0);
  return bytes_wanted_ <= most_bytes_ && points < kNone;
}

/// The cut of the edge from `below` to `above`.
ChainSet::Step LineTracer::cut(const Corner& below, const Corner& above,
                               std::uint32_t level) const noexcept {
  const auto end_of = [&](const Corner& c) {
    return CutEnd{static_cast<double>(c.position.x), static_cast<double>(c.position.y),
                  heights_.code(height_of_ordered(c.height, heights_.type))};
  };
  const MapPoint p = cut_of(end_of(below), end_of(above), levels_.code(level));
  return {{key_of(below.position), key_of(above.position)}, map_.to_map(p.x, p.y)};
}

/// The cut of the edge between the centre of the star and a corner.
ChainSet::Step LineTracer::spoke(const Corner& corner, bool is_centre_above,
                                 std::uint32_t level) const noexcept {
  return is_centre_above ? cut(corner, centre_, level) : cut(centre_, corner, level);
}

/// Joins what came last: near to each other in the file, most chains are so on the ground.
void LineTracer::join_batch() {
  batch_.join(context_, [&](const IsolinePiece& piece, std::span<const MapPoint> points) {
    piece.ring ? put(piece, points) : chains_.add(piece, points);
  });
  batch_.clear();
}

/// Keeps a piece that is done.
void LineTracer::put(IsolinePiece piece, std::span<const MapPoint> points) {
  piece.first = traced_.points.size();
  traced_.points.insert(traced_.points.end(), points.begin(), points.end());
  traced_.pieces.push_back(piece);
}

const TracedPieces& LineTracer::join() {
  join_batch();
  traced_.points.reserve(traced_.points.size() + chains_.points());
  chains_.join(context_, [&](const IsolinePiece& piece, std::span<const MapPoint> points) {
    put(piece, points);
  });
  return traced_;
}

}  // namespace ptin
