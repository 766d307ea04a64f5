// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sides of rings are clipped at each surface triangle below them, in shares of the way along the
// side. The share at which a side crosses an edge is computed from the edge alone, its ends in the
// order of their keys, so the triangles on both hands give the same bits.
#include "engine/construct/delaunay/line_drape.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <tuple>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/box.h"
#include "engine/geometry/infinity.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// Points that are triangulated at once: some 16 MB, at 250 bytes each (DelaunayTiler::make()).
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
  // -log10 of a power of ten may lie a little above the whole number: 1e-9 keeps it from another
  // digit.
  const double digits = std::ceil(-std::log10(step) - 1e-9);
  const int decimals = static_cast<int>(std::clamp(digits, 0.0, 9.0));
  // A double has up to 309 digits before the point, a sign, and here at most 9 digits behind it.
  char text[400];
  const auto [end, status] =
      std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals);
  Decimal number;
  if (status != std::errc() || parse_number({text, end}, number) != NumberKind::kNumber) {
    return decimal_of(value);
  }
  return number;
}

}  // namespace

LineDrape::LineDrape(const LineSet& rings, const LineSet& lines, const PointBuckets& points)
    : points_(points), rings_(rings.size()) {
  std::vector<GridBox> boxes;
  add_sides(rings, boxes);
  add_sides(lines, boxes);
  boxes_ = PackedBoxes(std::move(boxes));
}

void LineDrape::add_sides(const LineSet& set, std::vector<GridBox>& boxes) {
  const AffineMap& map = points_.frame().map;
  const auto place = [&](const SourcePoint& p) {
    const MapPoint g = map.to_grid({to_double(p.x), to_double(p.y)});
    return GridPoint{static_cast<std::int32_t>(std::lround(g.x)),
                     static_cast<std::int32_t>(std::lround(g.y))};
  };
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto line = set.line(i);
    for (std::size_t k = 1; k < line.size(); ++k) {
      const Side side{place(line[k - 1]), place(line[k])};
      // A side shorter than the grid is none: its ends are one vertex.
      if (side.from != side.to) {
        sides_.push_back(side);
        boxes.push_back(united(box_of(side.from), side.to));
      }
    }
    ends_.push_back(static_cast<std::uint32_t>(sides_.size()));
  }
}

void LineDrape::add(const DelaunayTile& part) {
  const Tin& tin = part.tin;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != TriangleClass::kSurface) {
      continue;
    }
    GridBox box;
    for (const VertexId v : tin.triangles[t].v) {
      box = united(box, tin.position(v));
    }
    boxes_.visit([&](const GridBox& b) { return meets(b, box); },
                 [&](std::size_t side) { add(part, t, static_cast<std::uint32_t>(side)); });
  }
}

/// Clips one side at one triangle.
void LineDrape::add(const DelaunayTile& part, TriangleId t, std::uint32_t number) {
  const Tin& tin = part.tin;
  const Side& side = sides_[number];
  Stretch s{number, 0.0, 1.0};
  for (int i = 0; i < 3; ++i) {
    GridPoint a = tin.position(tin.triangles[t].v[next_corner(i)]);
    GridPoint b = tin.position(tin.triangles[t].v[previous_corner(i)]);
    // The triangle beyond computes with the same numbers: so both find the same bits, and stretches
    // meet without a gap.
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
    const bool is_line = !part.fixed_sides.empty() && (part.fixed_sides[t] >> i & 1) != 0;
    // Where both ends are as far from the edge, neither lies out alone, and the share is not used.
    const double share = from / (from - to);
    if (starts_out && share > s.begin) {
      s.begin = share;
      s.begins_at_line = is_line;
    } else if (ends_out && share < s.end) {
      s.end = share;
      s.ends_at_line = is_line;
    }
  }
  // A side that touches a corner alone, or misses by rounding, has no stretch here.
  if (s.end - s.begin > tolerance_of(side.from, side.to)) {
    s.height_at_begin = height_in(tin, t, side, s.begin);
    s.height_at_end = height_in(tin, t, side, s.end);
    if (s.begins_at_line) {
      note_crossing(side, s.begin);
    }
    if (s.ends_at_line) {
      note_crossing(side, s.end);
    }
    stretches_.push_back(s);
  }
}

void LineDrape::note_crossing(const Side& side, double share) {
  const auto between = [&](std::int32_t a, std::int32_t b) {
    return a + share * (static_cast<double>(b) - a);
  };
  crossings_.push_back({rounded(side.from, side.to, share),
                        {between(side.from.x, side.to.x), between(side.from.y, side.to.y)}});
}

/// The fixed edge that a point lies on, or nearest to; FixedEdges has one at least.
std::uint32_t LineDrape::edge_at(MapPoint p) const {
  const FixedEdges& fixed = points_.fixed_edges();
  // Boxes of edges have whole coordinates, so rounding outward meets that of the edge crossed also
  // where p is a little off.
  const GridBox box{
      static_cast<std::int32_t>(std::floor(p.x)), static_cast<std::int32_t>(std::floor(p.y)),
      static_cast<std::int32_t>(std::ceil(p.x)), static_cast<std::int32_t>(std::ceil(p.y))};
  std::uint32_t nearest = 0;
  double least = kInfinity;
  fixed.visit([&](const GridBox& b) { return meets(b, box); },
              [&](std::uint32_t e) {
                const GridPoint a = fixed.vertices()[fixed.edges()[e].a].position;
                const GridPoint b = fixed.vertices()[fixed.edges()[e].b].position;
                const double ux = static_cast<double>(b.x) - a.x,
                             uy = static_cast<double>(b.y) - a.y;
                const double px = p.x - a.x, py = p.y - a.y;
                const double t = std::clamp((px * ux + py * uy) / (ux * ux + uy * uy), 0.0, 1.0);
                const double away = std::hypot(px - t * ux, py - t * uy);
                // The smaller number among equals makes the order of the visits irrelevant.
                if (away < least || (away == least && e < nearest)) {
                  least = away;
                  nearest = e;
                }
              });
  return nearest;
}

LineSet LineDrape::divided_lines(bool of_boundary) const {
  const FixedEdges& fixed = points_.fixed_edges();
  const HeightEncoding& heights = points_.frame().heights;
  std::vector<std::pair<std::uint32_t, GridPoint>> cuts;
  cuts.reserve(crossings_.size());
  for (const LineCrossing& c : crossings_) {
    cuts.emplace_back(edge_at(c.exact), c.place);
  }
  const auto along = [&](const std::pair<std::uint32_t, GridPoint>& cut) {
    const GridPoint a = fixed.vertices()[fixed.edges()[cut.first].a].position;
    return std::hypot(static_cast<double>(cut.second.x) - a.x,
                      static_cast<double>(cut.second.y) - a.y);
  };
  std::sort(cuts.begin(), cuts.end(), [&](const auto& one, const auto& other) {
    // The key comes last, so crossings that round to one place stand side by side.
    return std::tuple(one.first, along(one), key_of(one.second)) <
           std::tuple(other.first, along(other), key_of(other.second));
  });
  LineSet lines;
  std::size_t next = 0;
  for (std::uint32_t e = 0; e < fixed.edges().size(); ++e) {
    const LineEdge& edge = fixed.edges()[e];
    const auto put_end = [&](std::uint32_t v) {
      lines.vertices.push_back(
          source_point({fixed.vertices()[v].position, heights.height(points_.fixed_height(v))}));
    };
    const std::size_t before = lines.vertices.size();
    put_end(edge.a);
    for (; next < cuts.size() && cuts[next].first == e; ++next) {
      const GridPoint p = cuts[next].second;
      // What rounds to an end of the edge, or to the place before, would make an edge of no length.
      const bool is_end =
          p == fixed.vertices()[edge.a].position || p == fixed.vertices()[edge.b].position;
      const bool is_again = next > 0 && cuts[next - 1] == cuts[next];
      const auto height = height_at_.find(key_of(p));
      if (!is_end && !is_again && height != height_at_.end()) {
        lines.vertices.push_back(source_point({p, height->second}));
      }
    }
    put_end(edge.b);
    if (of_boundary ? edge.boundary : edge.breakline) {
      lines.ends.push_back(lines.vertices.size());
    } else {
      lines.vertices.resize(before);
    }
  }
  return lines;
}

/// The height of a triangle where a side is so far along; where that rounds to a corner the height of
/// the vertex, so that a ring meets points and breaklines at their own heights.
double LineDrape::height_in(const Tin& tin, TriangleId t, const Side& side, double share) const {
  const HeightEncoding& heights = points_.frame().heights;
  const GridPoint place = rounded(side.from, side.to, share);
  MapPoint c[3];
  double code[3];
  for (int i = 0; i < 3; ++i) {
    const VertexId v = tin.triangles[t].v[i];
    const GridPoint p = tin.position(v);
    code[i] = heights.code(tin.vertices[v].height);
    if (p == place) {
      return heights.height_of_code(code[i]);
    }
    // Corners are taken from the crossing, so that little is lost where differences are small.
    c[i] = {(p.x - side.from.x) - share * (static_cast<double>(side.to.x) - side.from.x),
            (p.y - side.from.y) - share * (static_cast<double>(side.to.y) - side.from.y)};
  }
  double sum = 0.0, area = 0.0;
  for (int i = 0; i < 3; ++i) {
    const MapPoint &p = c[next_corner(i)], &q = c[previous_corner(i)];
    // On an edge rounding may put the crossing a little outside.
    const double weight = std::max(0.0, p.x * q.y - p.y * q.x);
    sum += code[i] * weight;
    area += weight;
  }
  // The lines are read with the points: heights between steps would make the step of all finer.
  const double height = heights.height_of_code(sum / area);
  const double quantum = points_.frame().height_quantum;
  return std::round(height / quantum) * quantum;
}

/// Puts the vertices of a side; its last one only where the side ends on the ground. Where the side
/// goes without ground from one vertex that has some to another, a vertex without stands between.
/// @param next  The first stretch of the side, and then of the side behind it.
void LineDrape::put_side(std::uint32_t number, std::size_t& next,
                         std::vector<RingVertex>& ring) const {
  const Side& side = sides_[number];
  const double one = tolerance_of(side.from, side.to);
  const auto put = [&](double share, std::optional<double> height, bool on_line = false) {
    const GridPoint p = rounded(side.from, side.to, share);
    if (ring.empty() || ring.back().position != p) {
      ring.push_back({p, height, on_line});
    } else if (height && (on_line || !ring.back().height)) {
      // A gap below a grid unit is none: a side on the ground must stay an edge.
      ring.back() = {p, height, on_line};
    }
  };
  double done = 0.0;
  // A vertex without ground begins the side if no stretch does.
  if (next == stretches_.size() || stretches_[next].side != number ||
      stretches_[next].begin > one) {
    put(0.0, std::nullopt);
  }
  for (; next < stretches_.size() && stretches_[next].side == number; ++next) {
    const Stretch& s = stretches_[next];
    if (s.begin > done + one) {
      put((done + s.begin) / 2.0, std::nullopt);
    }
    // Two triangles along one edge give the same stretch twice: the second adds nothing.
    if (s.begin > done + one || done == 0.0) {
      put(s.begin, s.height_at_begin, s.begins_at_line);
    }
    if (s.end > done + one) {
      put(s.end, s.height_at_end, s.ends_at_line);
      done = s.end;
    }
  }
  if (done < 1.0 - one) {
    put((done + 1.0) / 2.0, std::nullopt);
  }
}

SourcePoint LineDrape::source_point(const RingVertex& v) const {
  const TerrainFrame& frame = points_.frame();
  const MapPoint p = frame.map.to_map(v.position.x, v.position.y);
  return {with_decimals(p.x, frame.map.step_x), with_decimals(p.y, frame.map.step_y),
          with_decimals(v.height.value_or(0.0), frame.height_quantum)};
}

/// Where several vertices fall together the height of a fixed edge stands, or else that of the first.
void LineDrape::note_heights(const std::vector<RingVertex>& chain) {
  // try_emplace() keeps what came first.
  for (const bool on_line : {true, false}) {
    for (const RingVertex& v : chain) {
      if (v.height && v.on_line == on_line) {
        height_at_.try_emplace(key_of(v.position), *v.height);
      }
    }
  }
}

/// Closes a ring.
void LineDrape::add_ring(std::vector<RingVertex>& ring, LineSet& to) {
  if (ring.back().position != ring.front().position) {
    ring.push_back(ring.front());
  }
  note_heights(ring);
  for (RingVertex& v : ring) {
    if (v.height) {
      v.height = height_at_.at(key_of(v.position));
    }
    to.vertices.push_back(source_point(v));
    to.has_ground.push_back(v.height ? 1 : 0);
  }
  to.ends.push_back(to.vertices.size());
}

/// A point keeps its height where a line is rounded to its place.
void LineDrape::note_points() {
  std::vector<BucketPoint> batch;
  for (std::uint64_t first = 0; first < points_.size(); first += kPartPoints) {
    points_.take(first, std::min(kPartPoints, points_.size() - first), batch);
    for (const BucketPoint& p : batch) {
      if (const auto at = height_at_.find(key_of(p.position)); at != height_at_.end()) {
        at->second = points_.frame().heights.height(p.height);
      }
    }
  }
}

/// Adds the pieces of a line that have ground.
void LineDrape::add_line(const std::vector<RingVertex>& line, LineSet& to) const {
  std::size_t begin = to.vertices.size();
  const auto end_piece = [&] {
    // A single vertex on the ground is no line.
    if (to.vertices.size() - begin < 2) {
      to.vertices.resize(begin);
    } else {
      to.ends.push_back(to.vertices.size());
    }
    begin = to.vertices.size();
  };
  for (const RingVertex& v : line) {
    if (!v.height) {
      end_piece();
      continue;
    }
    to.vertices.push_back(source_point({v.position, height_at_.at(key_of(v.position))}));
  }
  end_piece();
}

LineDrape::Laid LineDrape::lay(std::optional<double> longest_edge, std::uint64_t most_vertices,
                               const std::stop_token& stop, const Progress& progress) {
  DelaunayTiler tiler(points_, longest_edge);
  for (std::uint64_t first = 0; first < points_.size(); first += kPartPoints) {
    add(tiler.make(first, std::min(kPartPoints, points_.size() - first), stop));
    if (stretches_.size() + crossings_.size() > most_vertices) {
      throw Error(ErrorCode::resource_exhausted,
                  "the lines without heights cross more than " + std::to_string(most_vertices) +
                      " triangles, which is what a quarter of --memory has room for; give more "
                      "--memory");
    }
    if (progress) {
      progress(first, points_.size());
    }
  }
  // Heights are compared too: the result does not depend on the order of parts and triangles.
  std::sort(stretches_.begin(), stretches_.end(), [](const Stretch& a, const Stretch& b) {
    return std::tie(a.side, a.begin, a.end, a.height_at_begin, a.height_at_end) <
           std::tie(b.side, b.begin, b.end, b.height_at_begin, b.height_at_end);
  });
  Laid laid;
  height_at_.clear();
  std::vector<std::vector<RingVertex>> lines;
  std::size_t next = 0;
  std::uint32_t side = 0;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    std::vector<RingVertex> chain;
    for (; side < ends_[i]; ++side) {
      put_side(side, next, chain);
    }
    if (i < rings_ && !chain.empty()) {
      add_ring(chain, laid.rings);
    } else if (i >= rings_) {
      note_heights(chain);
      lines.push_back(std::move(chain));
    }
  }
  // Lines are written last, when rings and all other lines have said how high shared places are.
  if (!lines.empty()) {
    note_points();
  }
  for (const std::vector<RingVertex>& line : lines) {
    add_line(line, laid.lines);
  }
  return laid;
}

}  // namespace ptin
