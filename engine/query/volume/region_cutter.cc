// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/region_cutter.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/affine_rounding.h"
#include "engine/query/shape/clip.h"
#include "engine/query/volume/grid_box.h"

namespace ptin {

namespace {

constexpr std::size_t kFewEdges = 12;  // all pairs of them are looked at
constexpr int kMostHalvings = 40;
/// Halvings one after the other that leave as many edges: these meet in one place or lie on another.
constexpr int kMostInVain = 8;
/// Edges and pairs of edges that are looked at for one piece.
constexpr std::uint64_t kMostLooks = std::uint64_t{1} << 26;

void look(std::uint64_t& looks, std::uint64_t more) {
  looks += more;
  if (looks > kMostLooks) {
    throw Error(
        ErrorCode::resource_exhausted,
        "too many sides of the region meet in one place to cut a triangle at them; simplify "
        "the region there");
  }
}

}  // namespace

RegionCutter::RegionCutter(const Region& region, const AffineMap& map) : region_(region, map) {
  if (const auto* window = std::get_if<Window>(&region)) {
    const MapPoint corners[] = {{window->min_x, window->min_y},
                                {window->max_x, window->min_y},
                                {window->max_x, window->max_y},
                                {window->min_x, window->max_y}};
    add_ring(corners, map);
  } else if (const auto* polygon = std::get_if<Polygon>(&region)) {
    for (const std::vector<MapPoint>& ring : polygon->rings) add_ring(ring, map);
  } else {
    refuse("a volume is asked of a window or a polygon; a point has no inside");
  }
  cancel_pairs();
  std::vector<Interval> reaches;
  reaches.reserve(edges_.size());
  for (const Edge& e : edges_) reaches.push_back({e.low.y, e.high.y});
  bins_ = BinsAlongY(reaches);
}

/// Two edges between the same ends bound nothing, by the even-odd rule.
void RegionCutter::cancel_pairs() {
  const auto ends = [](const Edge& e) { return std::tuple(e.low.y, e.low.x, e.high.y, e.high.x); };
  for (Edge& e : edges_) {
    if (e.low.y == e.high.y && e.low.x > e.high.x) std::swap(e.low, e.high);
  }
  std::sort(edges_.begin(), edges_.end(),
            [&](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
  std::vector<Edge> kept;
  for (const Edge& e : edges_) {
    if (!kept.empty() && ends(kept.back()) == ends(e)) {
      kept.pop_back();
    } else {
      kept.push_back(e);
    }
  }
  edges_ = std::move(kept);
}

void RegionCutter::add_ring(std::span<const MapPoint> ring, const AffineMap& map) {
  const auto grid_of = [&](MapPoint p) {
    return MapPoint{snapped_to_grid(p.x, map.origin_x, map.step_x),
                    snapped_to_grid(p.y, map.origin_y, map.step_y)};
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    MapPoint a = grid_of(ring[i]);
    MapPoint b = grid_of(ring[(i + 1) % ring.size()]);
    if (a.y > b.y) std::swap(a, b);
    edges_.push_back({a, b});
  }
}

RegionCutter::Edges RegionCutter::edges_along(const GridWindow& extent) const {
  Edges along;
  bins_.visit(extent.min_y, extent.max_y, [&](std::uint32_t i) { along.push_back(&edges_[i]); });
  return along;
}

GridWindow RegionCutter::extent_of(const ConvexPiece& piece) {
  const MapPoint p = piece.corners().front();
  GridWindow extent{p.x, p.y, p.x, p.y};
  for (const MapPoint q : piece.corners()) {
    extent = {std::min(extent.min_x, q.x), std::min(extent.min_y, q.y), std::max(extent.max_x, q.x),
              std::max(extent.max_y, q.y)};
  }
  return extent;
}

void RegionCutter::cut(const ConvexPiece& piece, std::vector<ConvexPiece>& parts) const {
  if (piece.is_empty()) return;
  const GridWindow e = extent_of(piece);
  const GridBox box = box_between({e.min_x, e.min_y}, {e.max_x, e.max_y});
  if (!region_.meets(box)) return;
  if (region_.contains(box)) {
    parts.push_back(piece);
    return;
  }
  std::uint64_t looks = 0;
  cut_along(piece, edges_along(e), {.looks = &looks}, parts);
}

/// @param along  Edges, among them all that meet the piece's extent along y and lie in it or left of
///               it.
void RegionCutter::cut_along(const ConvexPiece& piece, const Edges& along, Halvings done,
                             std::vector<ConvexPiece>& parts) {
  if (piece.is_empty()) return;
  const GridWindow e = extent_of(piece);
  look(*done.looks, along.size());
  Edges local, left;
  for (const Edge* edge : along) {
    const bool is_beside = edge->low.y >= e.max_y || edge->high.y <= e.min_y;
    if (is_beside || std::min(edge->low.x, edge->high.x) > e.max_x) continue;
    (std::max(edge->low.x, edge->high.x) < e.min_x ? left : local).push_back(edge);
  }
  done.in_vain = local.size() < done.edges ? 0 : done.in_vain + 1;
  done.edges = local.size();
  if (local.size() <= kFewEdges || done.all == kMostHalvings || done.in_vain == kMostInVain) {
    look(*done.looks, local.size() * local.size());
    const std::vector<double> ends = slab_ends(e, local);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      cut_in_slab(piece, ends[i], ends[i + 1], local, left, parts);
    }
    return;
  }
  MapPoint a{(e.min_x + e.max_x) / 2, e.max_y}, b{a.x, e.min_y};
  if (e.max_y - e.min_y > e.max_x - e.min_x) {
    a = {e.min_x, (e.min_y + e.max_y) / 2};
    b = {e.max_x, a.y};
  }
  local.insert(local.end(), left.begin(), left.end());
  ConvexPiece one = piece, other = piece;
  one.keep_left(a, b);
  other.keep_left(b, a);
  ++done.all;
  cut_along(one, local, done, parts);
  cut_along(other, local, done, parts);
}

/// Where slabs of a piece begin and end, ascending: between them no edge begins, ends or crosses
/// another.
std::vector<double> RegionCutter::slab_ends(const GridWindow& extent, const Edges& local) {
  std::vector<double> ends = {extent.min_y, extent.max_y};
  const auto add = [&](double y) {
    if (y > extent.min_y && y < extent.max_y) ends.push_back(y);
  };
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Edge& a = *local[i];
    add(a.low.y);
    add(a.high.y);
    for (std::size_t j = 0; j < i; ++j) {
      const Edge& b = *local[j];
      const double low = cross(a.low, a.high, b.low), high = cross(a.low, a.high, b.high);
      if ((low > 0) != (high > 0)) add(b.low.y + low / (low - high) * (b.high.y - b.low.y));
    }
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// @param local  Edges in the extent of the piece.
/// @param left   Edges left of it, which tell whether it begins inside.
void RegionCutter::cut_in_slab(const ConvexPiece& piece, double low, double high,
                               const Edges& local, const Edges& left,
                               std::vector<ConvexPiece>& parts) {
  const double middle = (low + high) / 2;
  if (!(low < middle && middle < high)) return;
  const auto spans = [&](const Edge* e) { return e->low.y <= middle && middle < e->high.y; };
  bool inside = std::count_if(left.begin(), left.end(), spans) % 2 != 0;
  const GridWindow extent = extent_of(piece);
  double side = extent.min_x;
  std::vector<std::pair<double, const Edge*>> across;
  for (const Edge* e : local) {
    if (!spans(e)) continue;
    across.emplace_back(e->x_at(middle), e);
    side = std::min({side, e->x_at(low), e->x_at(high)});
  }
  std::sort(across.begin(), across.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  MapPoint from_low{side - 1, low}, from_high{side - 1, high};
  const auto take = [&](double x_low, double x_high) {
    const MapPoint to_low{std::max(x_low, from_low.x), low};
    const MapPoint to_high{std::max(x_high, from_high.x), high};
    if (inside) {
      ConvexPiece part = piece;
      part.keep_in({from_low, to_low, to_high, from_high});
      if (!part.is_empty()) parts.push_back(part);
    }
    inside = !inside;
    from_low = to_low;
    from_high = to_high;
  };
  for (const auto& [x, e] : across) take(e->x_at(low), e->x_at(high));
  if (inside) take(extent.max_x + 1, extent.max_x + 1);
}

}  // namespace ptin
