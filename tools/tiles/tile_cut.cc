// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/tile_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/query/shape/clip.h"

namespace ptin::tools {

namespace {

Vec3 unit(const Vec3& v, const Vec3& otherwise) {
  const double l = length(v);
  return l > 0 ? (1.0 / l) * v : otherwise;
}

Vec3 vector_of(const std::array<std::int64_t, 3>& n) {
  return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
}

/// The nearest place on a border that is no corner of tiles, unless `place` is one exactly. So the
/// only points at a corner are those that all four tiles have: vertices, and the cut point of the
/// triangle that holds the corner.
std::int64_t off_corners(double place) {
  const std::int64_t at = std::llround(place);
  const auto rounded = static_cast<double>(at);
  if (at % kTileSteps != 0 || rounded == place) return at;
  return place > rounded ? at + 1 : at - 1;
}

bool is_near(const TilePoint& a, const TilePoint& b) {
  return std::abs(a.u - b.u) <= TileCut::kNearby && std::abs(a.v - b.v) <= TileCut::kNearby;
}

}  // namespace

const std::vector<TileCut::Id>& TileCut::cut(const LevelMesh::Corners& triangle) {
  polygon_.assign(triangle.begin(), triangle.end());
  const TileBox box = mesh_.box_of(triangle);
  if (tile_.contains(box)) return polygon_;
  if (!tile_.meets(box)) {
    polygon_.clear();
    return polygon_;
  }
  normal_ = mesh_.normal_of(triangle);
  cut_at({Axis::kU, tile_.min_u, false});
  cut_at({Axis::kU, tile_.max_u, true});
  cut_at({Axis::kV, tile_.min_v, false});
  cut_at({Axis::kV, tile_.max_v, true});
  if (polygon_.size() < 3) polygon_.clear();
  return polygon_;
}

std::int64_t TileCut::twice_area() const noexcept {
  std::int64_t twice = 0;
  for (std::size_t i = 2; i < polygon_.size(); ++i) {
    const TilePoint& a = point(polygon_[0]).at;
    const TilePoint& b = point(polygon_[i - 1]).at;
    const TilePoint& c = point(polygon_[i]).at;
    twice += (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
  }
  return twice;
}

void TileCut::cut_at(const Border& border) {
  rest_.clear();
  // Two points along a border have one edge, which is crossed once, not there and back: its
  // triangle is beside the tile, and is one of those around the cut point.
  const std::size_t edges = polygon_.size() == 2 ? 1 : polygon_.size();
  clip_convex(
      polygon_.size(),
      [&](std::size_t i) {
        const TilePoint& p = point(polygon_[i]).at;
        const std::int64_t beyond = (border.axis == Axis::kU ? p.u : p.v) - border.at;
        return border.is_upper ? -beyond : beyond;
      },
      [&](std::size_t i) { rest_.push_back(polygon_[i]); },
      [&](std::size_t i, std::size_t j) {
        if (i < edges) rest_.push_back(cross(polygon_[i], polygon_[j], border));
      });
  polygon_.swap(rest_);
}

TileCut::Id TileCut::cross(Id a, Id b, const Border& border) {
  // A point that the opposite border cut off stands for its whole edge, which the neighbour sees.
  const std::size_t old = mesh_.points().size();
  if (is_cut(a, border.axis)) {
    const CutPoint& whole = cuts_[a - old];
    std::tie(a, b) = std::pair(whole.low, whole.high);
  } else if (is_cut(b, border.axis)) {
    const CutPoint& whole = cuts_[b - old];
    std::tie(a, b) = std::pair(whole.low, whole.high);
  }
  const TilePoint& of_a = point(a).at;
  const TilePoint& of_b = point(b).at;
  if (border.axis == Axis::kU ? of_b.u < of_a.u : of_b.v < of_a.v) std::swap(a, b);
  auto& known = known_[(border.axis == Axis::kU ? 0U : 2U) + (border.is_upper ? 1U : 0U)];
  const auto next = static_cast<Id>(old + cuts_.size());
  const auto [it, is_new] = known.try_emplace((std::uint64_t{a} << 32) | b, next);
  if (is_new) cuts_.push_back(cut_point(a, b, border));
  for (std::size_t i = 0; i < 3; ++i) cuts_[it->second - old].point.normal[i] += normal_[i];
  return it->second;
}

TileCut::CutPoint TileCut::cut_point(Id low, Id high, const Border& border) const {
  const LevelPoint& a = point(low);
  const LevelPoint& b = point(high);
  const bool along_v = border.axis == Axis::kU;
  const auto across = [&](const TilePoint& p) { return along_v ? p.u : p.v; };
  const auto along = [&](const TilePoint& p) { return along_v ? p.v : p.u; };
  CutPoint cut;
  cut.low = low;
  cut.high = high;
  cut.axis = border.axis;
  cut.share = static_cast<double>(border.at - across(a.at)) /
              static_cast<double>(across(b.at) - across(a.at));
  const std::int64_t at = off_corners(static_cast<double>(along(a.at)) +
                                      cut.share * static_cast<double>(along(b.at) - along(a.at)));
  cut.point.at = along_v ? TilePoint{border.at, at} : TilePoint{at, border.at};
  cut.point.height = a.height + cut.share * (b.height - a.height);
  return cut;
}

Vec3 TileCut::normal(Id id) const {
  const std::size_t old = mesh_.points().size();
  const LevelPoint& p = point(id);
  const LevelFrame& frame = mesh_.frame();
  const GlobePoint at = frame.grid.globe_point(frame.level, p.at, 0.0);
  const Vec3 up = up_at(at.lon, at.lat);
  if (id >= old) {
    const CutPoint& cut = cuts_[id - old];
    const bool has_vertices = cut.low < old && cut.high < old;
    if (has_vertices && is_near(point(cut.low).at, p.at) && is_near(point(cut.high).at, p.at)) {
      return unit((1.0 - cut.share) * normal(cut.low) + cut.share * normal(cut.high), up);
    }
  }
  return unit(vector_of(p.normal), up);
}

}  // namespace ptin::tools
