// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/line_noding.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "engine/construct/lines/edge_boxes.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/stop.h"

namespace ptin {

namespace {

/// Rounding makes few new crossings, and those of these fewer still.
constexpr int kMostRounds = 40;

/// A vertex that divides an edge.
struct Division {
  std::uint32_t edge, vertex;
};

class Noding {
 public:
  Noding(LineGraph&& lines, const NodingRules& rules, const std::stop_token& stop)
      : graph_(std::move(lines)), rules_(rules), stop_(stop) {}

  LineGraph run();

 private:
  [[noreturn]] void refuse_heights(GridPoint at, double one, double other) const;
  [[nodiscard]] GridPoint at(std::uint32_t vertex) const {
    return graph_.vertices[vertex].position;
  }
  [[nodiscard]] double height(std::uint32_t vertex) const { return graph_.vertices[vertex].height; }
  [[nodiscard]] double slope(const LineEdge& e) const;
  [[nodiscard]] double height_on(const LineEdge& e, GridPoint p) const;

  void join_vertices();
  void join_edges();
  void meet(std::uint32_t one, std::uint32_t other);
  bool touch(std::uint32_t edge, std::uint32_t vertex, const LineEdge& of);
  std::uint32_t vertex_at(GridPoint p, double height);
  [[noreturn]] void refuse_memory() const;
  void cross(std::uint32_t one, std::uint32_t other);
  void divide();
  void sort_all();

  LineGraph graph_;
  NodingRules rules_;
  std::stop_token stop_;
  std::unordered_map<VertexKey, std::uint32_t> by_place_;
  std::vector<Division> divisions_;
};

double distance(GridPoint a, GridPoint b) {
  return std::hypot(static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y);
}

void Noding::refuse_heights(GridPoint p, double one, double other) const {
  const MapPoint place = rules_.map.to_map(p.x, p.y);
  const auto [low, high] = std::minmax(one, other);
  char text[300];
  std::snprintf(text, sizeof text,
                "breaklines (or the boundary) meet at %.15g %.15g with two heights, %.9g and %.9g; "
                "give both lines one height there, or leave one of them out",
                place.x, place.y, low * rules_.height_of_unit, high * rules_.height_of_unit);
  refuse(text);
}

/// The rise of an edge over a grid unit.
double Noding::slope(const LineEdge& e) const {
  return std::abs(height(e.b) - height(e.a)) / distance(at(e.a), at(e.b));
}

/// The height of an edge beside a grid position that lies on it, or next to it.
double Noding::height_on(const LineEdge& e, GridPoint p) const {
  const GridPoint a = at(e.a), b = at(e.b);
  const double dx = static_cast<double>(b.x) - a.x, dy = static_cast<double>(b.y) - a.y;
  const double along =
      (static_cast<double>(p.x) - a.x) * dx + (static_cast<double>(p.y) - a.y) * dy;
  const double t = std::clamp(along / (dx * dx + dy * dy), 0.0, 1.0);
  return height(e.a) + t * (height(e.b) - height(e.a));
}

/// Makes one of the vertices at each position.
void Noding::join_vertices() {
  std::vector<std::uint32_t> place(graph_.vertices.size());
  std::vector<GridVertex> kept;
  std::vector<double> highest;
  for (std::size_t i = 0; i < graph_.vertices.size(); ++i) {
    const GridVertex& v = graph_.vertices[i];
    const auto [found, is_new] =
        by_place_.try_emplace(key_of(v.position), static_cast<std::uint32_t>(kept.size()));
    place[i] = found->second;
    if (is_new) {
      kept.push_back(v);
      highest.push_back(v.height);
      continue;
    }
    double& low = kept[place[i]].height;
    low = std::min(low, v.height);
    highest[place[i]] = std::max(highest[place[i]], v.height);
    if (rules_.compares_heights && highest[place[i]] - low > rules_.height_step) {
      refuse_heights(v.position, low, highest[place[i]]);
    }
  }
  graph_.vertices = std::move(kept);
  for (LineEdge& e : graph_.edges) {
    e.a = place[e.a];
    e.b = place[e.b];
  }
}

/// Drops edges without a length, and makes one of those between the same ends.
void Noding::join_edges() {
  std::vector<LineEdge>& edges = graph_.edges;
  for (LineEdge& e : edges) {
    if (e.a > e.b) {
      std::swap(e.a, e.b);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const LineEdge& e, const LineEdge& f) {
    return std::tie(e.a, e.b) < std::tie(f.a, f.b);
  });
  std::size_t kept = 0;
  for (const LineEdge& e : edges) {
    if (e.a == e.b) {
      continue;
    }
    if (kept > 0 && edges[kept - 1].a == e.a && edges[kept - 1].b == e.b) {
      edges[kept - 1].breakline |= e.breakline;
      edges[kept - 1].boundary ^= e.boundary;
    } else {
      edges[kept++] = e;
    }
  }
  edges.resize(kept);
}

/// Notes that a vertex divides an edge when it lies inside of it. True then.
/// @param of  The edge that the vertex belongs to.
bool Noding::touch(std::uint32_t edge, std::uint32_t vertex, const LineEdge& of) {
  const LineEdge& e = graph_.edges[edge];
  const GridPoint a = at(e.a), b = at(e.b), p = at(vertex);
  if (vertex == e.a || vertex == e.b || orient(a, b, p) != 0 ||
      !contains(united(box_of(a), b), p)) {
    return false;
  }
  const double on_edge = height_on(e, p);
  if (rules_.compares_heights &&
      std::abs(on_edge - height(vertex)) > rules_.height_step + slope(e) + slope(of)) {
    refuse_heights(p, on_edge, height(vertex));
  }
  if (divisions_.size() >= 4 * rules_.most_vertices) {
    refuse_memory();
  }
  divisions_.push_back({edge, vertex});
  return true;
}

/// The vertex at a position, a new one of this height where there is none.
std::uint32_t Noding::vertex_at(GridPoint p, double height) {
  const auto next = static_cast<std::uint32_t>(graph_.vertices.size());
  const auto [found, is_new] = by_place_.try_emplace(key_of(p), next);
  if (is_new) {
    if (next >= rules_.most_vertices) {
      refuse_memory();
    }
    graph_.vertices.push_back({p, rules_.whole_heights ? std::nearbyint(height) : height});
  }
  return found->second;
}

void Noding::refuse_memory() const {
  throw Error(ErrorCode::resource_exhausted,
              "breaklines and boundary have more than " + std::to_string(rules_.most_vertices) +
                  " vertices where they are divided at their crossings, which is what a quarter of "
                  "--memory has room for; give more --memory, or fewer lines");
}

/// Notes that two edges that cross divide each other, in a vertex that is new or there already.
void Noding::cross(std::uint32_t one, std::uint32_t other) {
  __extension__ using Wide = __int128;
  const LineEdge e = graph_.edges[one], f = graph_.edges[other];
  const GridPoint a = at(e.a), b = at(e.b), c = at(f.a), d = at(f.b);
  const std::int64_t from_a = orient(c, d, a), from_b = orient(c, d, b);
  if ((orient(a, b, c) > 0) == (orient(a, b, d) > 0) || (from_a > 0) == (from_b > 0)) {
    return;
  }
  const Wide whole = from_a < 0 ? -(Wide{from_a} - from_b) : Wide{from_a} - from_b;
  const Wide part = from_a < 0 ? -Wide{from_a} : Wide{from_a};
  const auto along = [&](std::int64_t from, std::int64_t to) {  // to the nearest, halves upwards
    const Wide twice = 2 * part * (to - from) + whole;
    const Wide rounded =
        twice >= 0 ? twice / (2 * whole) : -((2 * whole - 1 - twice) / (2 * whole));
    return static_cast<std::int32_t>(from + static_cast<std::int64_t>(rounded));
  };
  const GridPoint p{along(a.x, b.x), along(a.y, b.y)};
  const auto from_c = static_cast<double>(orient(a, b, c));
  const auto from_d = static_cast<double>(orient(a, b, d));
  const double t = static_cast<double>(part) / static_cast<double>(whole);
  const double u = from_c / (from_c - from_d);
  const double on_e = height(e.a) + t * (height(e.b) - height(e.a));
  const double on_f = height(f.a) + u * (height(f.b) - height(f.a));
  const double bend = std::hypot(a.x + t * (static_cast<double>(b.x) - a.x) - p.x,
                                 a.y + t * (static_cast<double>(b.y) - a.y) - p.y);
  graph_.largest_bend = std::max(graph_.largest_bend, bend);
  const std::uint32_t vertex = vertex_at(p, std::min(on_e, on_f));
  for (const double other_height : {on_f, height(vertex)}) {
    if (rules_.compares_heights &&
        std::abs(on_e - other_height) > rules_.height_step + slope(e) + slope(f)) {
      refuse_heights(p, on_e, other_height);
    }
  }
  if (divisions_.size() >= 4 * rules_.most_vertices) {
    refuse_memory();
  }
  divisions_.push_back({one, vertex});
  divisions_.push_back({other, vertex});
}

/// Notes where two edges divide each other.
void Noding::meet(std::uint32_t one, std::uint32_t other) {
  const LineEdge e = graph_.edges[one], f = graph_.edges[other];
  bool touches = e.a == f.a || e.a == f.b || e.b == f.a || e.b == f.b;
  for (const std::uint32_t v : {f.a, f.b}) {
    touches = touch(one, v, f) || touches;
  }
  for (const std::uint32_t v : {e.a, e.b}) {
    touches = touch(other, v, e) || touches;
  }
  if (!touches) {
    cross(one, other);
  }
}

/// Divides edges as was noted.
void Noding::divide() {
  const auto distance_along = [&](const Division& d) {
    return distance(at(graph_.edges[d.edge].a), at(d.vertex));
  };
  std::sort(divisions_.begin(), divisions_.end(), [&](const Division& one, const Division& other) {
    if (one.edge != other.edge) {
      return one.edge < other.edge;
    }
    const double to_one = distance_along(one), to_other = distance_along(other);
    return to_one != to_other ? to_one < to_other
                              : key_of(at(one.vertex)) < key_of(at(other.vertex));
  });
  std::vector<LineEdge> more;
  for (std::size_t i = 0; i < divisions_.size(); ++i) {
    // The edge becomes its own last part; the parts before that are added.
    const Division& d = divisions_[i];
    LineEdge part = graph_.edges[d.edge];
    part.b = d.vertex;
    more.push_back(part);
    graph_.edges[d.edge].a = d.vertex;
  }
  graph_.edges.insert(graph_.edges.end(), more.begin(), more.end());
  divisions_.clear();
}

/// Sorts the vertices that edges need by position, and lets go of the others.
void Noding::sort_all() {
  std::vector<std::uint8_t> used(graph_.vertices.size(), 0);
  for (const LineEdge& e : graph_.edges) {
    used[e.a] = used[e.b] = 1;
  }
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) {
      order.push_back(v);
    }
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t v, std::uint32_t w) { return key_of(at(v)) < key_of(at(w)); });
  std::vector<std::uint32_t> place(graph_.vertices.size(), 0);
  std::vector<GridVertex> sorted;
  for (const std::uint32_t v : order) {
    place[v] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(graph_.vertices[v]);
  }
  graph_.vertices = std::move(sorted);
  for (LineEdge& e : graph_.edges) {
    e.a = place[e.a];
    e.b = place[e.b];
  }
  join_edges();
}

LineGraph Noding::run() {
  join_vertices();
  join_edges();
  sort_all();  // from here on nothing depends on the order of the lines
  by_place_.clear();
  for (std::uint32_t v = 0; v < graph_.vertices.size(); ++v) {
    by_place_.emplace(key_of(at(v)), v);
  }
  std::uint64_t met = 0;
  for (int round = 0;; ++round) {
    const EdgeBoxes boxes(graph_);
    for (std::uint32_t e = 0; e < graph_.edges.size(); ++e) {
      const GridBox box = united(box_of(at(graph_.edges[e].a)), at(graph_.edges[e].b));
      boxes.visit([&](const GridBox& other) { return meets(box, other); },
                  [&](std::uint32_t f) {
                    if (f > e) {
                      meet(e, f);
                    }
                    if (++met % kStopInterval == 0) {
                      stop_if_asked(stop_, "joining breaklines");
                    }
                  });
    }
    if (divisions_.empty()) {
      break;
    }
    if (round == kMostRounds) {
      const MapPoint place =
          rules_.map.to_map(at(divisions_[0].vertex).x, at(divisions_[0].vertex).y);
      char text[200];
      std::snprintf(text, sizeof text,
                    "breaklines cross again and again within a grid unit at %.15g %.15g; give a "
                    "finer --resolution, or leave one of them out",
                    place.x, place.y);
      refuse(text);
    }
    divide();
    join_edges();
  }
  sort_all();
  return std::move(graph_);
}

}  // namespace

LineGraph node_lines(LineGraph&& lines, const NodingRules& rules, const std::stop_token& stop) {
  return Noding(std::move(lines), rules, stop).run();
}

}  // namespace ptin
