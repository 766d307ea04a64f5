// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sides of rings are clipped at each surface triangle below them, in shares of the way along the
// side. The share at which a side crosses an edge is computed from the edge alone, its ends in the
// order of their keys, so the triangles on both hands give the same bits.
#include "engine/construct/delaunay/boundary_drape.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "engine/construct/delaunay/tile_delaunay.h"
#include "engine/error.h"
#include "engine/geometry/box.h"
#include "engine/geometry/orient.h"
#include "engine/geometry/rounding.h"

namespace ptin {

namespace {

/// Points that are triangulated at once.
constexpr std::uint64_t kPartPoints = std::uint64_t{1} << 16;

/// Shares that lie closer than this, in grid units along the side, are one.
constexpr double kOneShare = 1e-6;

double tolerance_of(GridPoint from, GridPoint to) {
  return kOneShare / std::max(1.0, std::hypot(static_cast<double>(to.x) - from.x,
                                              static_cast<double>(to.y) - from.y));
}

GridPoint rounded(GridPoint from, GridPoint to, double share) {
  const auto between = [&](std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(std::lround(a + share * (static_cast<double>(b) - a)));
  };
  return {between(from.x, to.x), between(from.y, to.y)};
}

/// A number with so many digits after the point.
Decimal with_decimals(double value, double step) {
  const double digits = std::ceil(-std::log10(step) - 1e-9);
  const int decimals = static_cast<int>(std::clamp(digits, 0.0, 9.0));
  char text[64];
  const int length = std::snprintf(text, sizeof text, "%.*f", decimals, value);
  Decimal number;
  if (parse_number({text, static_cast<std::size_t>(length)}, number) != NumberKind::kNumber) {
    return decimal_of(value);
  }
  return number;
}

}  // namespace

BoundaryDrape::BoundaryDrape(const LineSet& rings, const PointBuckets& points)
    : rings_(rings), points_(points) {
  const AffineMap& map = points.frame().map;
  const auto place = [&](const SourcePoint& p) {
    const MapPoint g = map.to_grid({to_double(p.x), to_double(p.y)});
    return GridPoint{static_cast<std::int32_t>(std::lround(g.x)),
                     static_cast<std::int32_t>(std::lround(g.y))};
  };
  std::vector<GridBox> boxes;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const auto ring = rings.line(i);
    for (std::size_t k = 1; k < ring.size(); ++k) {
      const Side side{place(ring[k - 1]), place(ring[k])};
      if (side.from != side.to) {
        sides_.push_back(side);
        boxes.push_back(united(box_of(side.from), side.to));
      }
    }
    ends_.push_back(static_cast<std::uint32_t>(sides_.size()));
  }
  boxes_ = PackedBoxes(std::move(boxes));
}

void BoundaryDrape::add(const Tin& tin) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != TriangleClass::kSurface) {
      continue;
    }
    GridBox box;
    for (const VertexId v : tin.triangles[t].v) {
      box = united(box, tin.position(v));
    }
    boxes_.visit([&](const GridBox& b) { return meets(b, box); },
                 [&](std::size_t side) { add(tin, t, static_cast<std::uint32_t>(side)); });
  }
}

/// Clips one side at one triangle.
void BoundaryDrape::add(const Tin& tin, TriangleId t, std::uint32_t number) {
  const Side& side = sides_[number];
  double begin = 0.0, end = 1.0;
  for (int i = 0; i < 3; ++i) {
    GridPoint a = tin.position(tin.triangles[t].v[next_corner(i)]);
    GridPoint b = tin.position(tin.triangles[t].v[previous_corner(i)]);
    const bool turned = key_of(b) < key_of(a);
    if (turned) {
      std::swap(a, b);
    }
    const auto from = static_cast<double>(orient(a, b, side.from));
    const auto to = static_cast<double>(orient(a, b, side.to));
    const bool starts_out = turned ? from > 0 : from < 0, ends_out = turned ? to > 0 : to < 0;
    if (starts_out && ends_out) {
      return;
    }
    if (starts_out) {
      begin = std::max(begin, from / (from - to));
    } else if (ends_out) {
      end = std::min(end, from / (from - to));
    }
  }
  if (end - begin > tolerance_of(side.from, side.to)) {
    stretches_.push_back({number, begin, end, height_in(tin, t, rounded(side.from, side.to, begin)),
                          height_in(tin, t, rounded(side.from, side.to, end))});
  }
}

/// The height of a triangle's plane at a grid point in it, or within rounding of it: on a corner
/// that of the vertex, so that a ring meets points and breaklines at their own heights.
double BoundaryDrape::height_in(const Tin& tin, TriangleId t, GridPoint p) const {
  const HeightEncoding& heights = points_.frame().heights;
  GridPoint c[3];
  double code[3];
  for (int i = 0; i < 3; ++i) {
    const VertexId v = tin.triangles[t].v[i];
    c[i] = tin.position(v);
    code[i] = heights.code(tin.vertices[v].height);
    if (c[i] == p) {
      return heights.height_of_code(code[i]);
    }
  }
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    sum += code[i] * static_cast<double>(orient(c[next_corner(i)], c[previous_corner(i)], p));
  }
  const double height = heights.height_of_code(sum / static_cast<double>(orient(c[0], c[1], c[2])));
  const double quantum = points_.frame().height_quantum;
  return std::round(height / quantum) * quantum;
}

/// Puts the vertices of a side; its last one only where the side ends on the ground. Where the side
/// goes without ground from one vertex that has some to another, a vertex without stands between.
/// @param next  The first stretch of the side, and then of the side behind it.
void BoundaryDrape::put_side(std::uint32_t number, std::size_t& next,
                             std::vector<Vertex3>& ring) const {
  const Side& side = sides_[number];
  const double one = tolerance_of(side.from, side.to);
  const auto put = [&](double share, std::optional<double> height) {
    const GridPoint p = rounded(side.from, side.to, share);
    if (ring.empty() || ring.back().position != p) {
      ring.push_back({p, height});
    }
  };
  double done = 0.0;
  if (next == stretches_.size() || stretches_[next].side != number ||
      stretches_[next].begin > one) {
    put(0.0, std::nullopt);
  }
  for (; next < stretches_.size() && stretches_[next].side == number; ++next) {
    const Stretch& s = stretches_[next];
    if (s.begin > done + one) {
      put((done + s.begin) / 2.0, std::nullopt);
    }
    if (s.begin > done + one || done == 0.0) {
      put(s.begin, s.height_at_begin);
    }
    if (s.end > done + one) {
      put(s.end, s.height_at_end);
      done = s.end;
    }
  }
  if (done < 1.0 - one) {
    put((done + 1.0) / 2.0, std::nullopt);
  }
}

SourcePoint BoundaryDrape::source_point(const Vertex3& v) const {
  const TerrainFrame& frame = points_.frame();
  const MapPoint p = frame.map.to_map(v.position.x, v.position.y);
  return {with_decimals(p.x, frame.map.step_x), with_decimals(p.y, frame.map.step_y),
          with_decimals(v.height.value_or(0.0), frame.height_quantum)};
}

LineSet BoundaryDrape::lay(std::optional<double> longest_edge, std::uint64_t most_vertices,
                           const std::stop_token& stop, const Progress& progress) {
  DelaunayTiler tiler(points_, longest_edge);
  for (std::uint64_t first = 0; first < points_.size(); first += kPartPoints) {
    add(tiler.make(first, std::min(kPartPoints, points_.size() - first), stop).tin);
    if (stretches_.size() > most_vertices) {
      throw Error(ErrorCode::resource_exhausted,
                  "the boundary crosses more than " + std::to_string(most_vertices) +
                      " triangles, which is what a quarter of --memory has room for; give more "
                      "--memory");
    }
    if (progress) {
      progress(first, points_.size());
    }
  }
  std::sort(stretches_.begin(), stretches_.end(), [](const Stretch& a, const Stretch& b) {
    return std::tie(a.side, a.begin, a.end, a.height_at_begin, a.height_at_end) <
           std::tie(b.side, b.begin, b.end, b.height_at_begin, b.height_at_end);
  });
  LineSet laid;
  std::unordered_map<VertexKey, double> height_at;  // one for each position
  std::size_t next = 0;
  std::uint32_t side = 0;
  for (const std::uint32_t end : ends_) {
    std::vector<Vertex3> ring;
    for (; side < end; ++side) {
      put_side(side, next, ring);
    }
    if (ring.empty()) {
      continue;
    }
    if (ring.back().position != ring.front().position) {
      ring.push_back(ring.front());
    }
    for (Vertex3& v : ring) {
      if (v.height) {
        v.height = height_at.try_emplace(key_of(v.position), *v.height).first->second;
      }
      laid.vertices.push_back(source_point(v));
      laid.has_ground.push_back(v.height ? 1 : 0);
    }
    laid.ends.push_back(laid.vertices.size());
  }
  return laid;
}

}  // namespace ptin
