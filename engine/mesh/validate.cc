// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/validate.h"

#include <unordered_set>
#include <vector>

#include "engine/geometry/orient.h"
#include "engine/mesh/star.h"

namespace ptin {

namespace {

std::string at_triangle(const char* what, TriangleId t) {
  return what + (" triangle " + std::to_string(t));
}
std::string at_vertex(const char* what, VertexId v) {
  return what + (" vertex " + std::to_string(v));
}

std::string check_orientation(const Tin& tin) {
  if (tin.has_height.size() != tin.vertices.size() || tin.classes.size() != tin.triangles.size()) {
    return "I1: the arrays beside each other differ in length";
  }
  std::unordered_set<VertexKey> keys;
  for (const Vertex& v : tin.vertices) {
    if (v.triangle != kNone && !keys.insert(key_of(v.position)).second) {
      return "I1: two vertices at " + std::to_string(v.position.x) + " " +
             std::to_string(v.position.y);
    }
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    const Triangle& triangle = tin.triangles[t];
    for (const VertexId v : triangle.v) {
      if (v >= tin.vertices.size() || tin.vertices[v].triangle == kNone ||
          !on_grid(tin.position(v))) {
        return at_triangle("I1: a corner is not an alive vertex on the grid:", t);
      }
    }
    if (orient(tin.position(triangle.v[0]), tin.position(triangle.v[1]),
               tin.position(triangle.v[2])) <= 0) {
      return at_triangle("I1: not counter-clockwise:", t);
    }
  }
  return {};
}

std::string check_neighbours(const Tin& tin) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    const Triangle& triangle = tin.triangles[t];
    for (int i = 0; i < 3; ++i) {
      const TriangleId n = triangle.n[i];
      if (n == kNone) {
        continue;
      }
      if (n >= tin.triangles.size() || !tin.is_alive(n)) {
        return at_triangle("I2: a neighbour is removed or out of range:", t);
      }
      const Triangle& other = tin.triangles[n];
      bool matched = false;
      for (int k = 0; k < 3; ++k) {
        matched |= other.n[k] == t && other.v[next_corner(k)] == triangle.v[previous_corner(i)] &&
                   other.v[previous_corner(k)] == triangle.v[next_corner(i)];
      }
      if (!matched) {
        return at_triangle("I2: a neighbour does not share the edge back:", t);
      }
    }
  }
  return {};
}

/// Fills `next` with the second end of the border edge that leaves each vertex with the domain on
/// its left; kNone where no border edge does. Fills `edges` with their number. Returns a fault in
/// words, or an empty string.
std::string collect_border(const Tin& tin, std::vector<VertexId>& next, std::size_t& edges) {
  next.assign(tin.vertices.size(), kNone);
  edges = 0;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    const Triangle& triangle = tin.triangles[t];
    for (int i = 0; i < 3; ++i) {
      if (triangle.n[i] == kNone) {
        VertexId& slot = next[triangle.v[next_corner(i)]];
        if (slot != kNone) {
          return at_vertex("I4: two border edges leave", triangle.v[next_corner(i)]);
        }
        slot = triangle.v[previous_corner(i)];
        ++edges;
      }
    }
  }
  return {};
}

/// True for directions in [0, 180) degrees.
bool points_up(GridPoint a, GridPoint b) { return b.y > a.y || (b.y == a.y && b.x > a.x); }

/// Checks that the border turns left or goes straight on everywhere, and goes round once. A mesh of
/// counter-clockwise triangles maps its disk onto the plane without folds, so inside of such a
/// border every point is covered as often as the border winds: once.
std::string check_convex(const Tin& tin, const std::vector<VertexId>& next, VertexId start) {
  int rounds = 0;
  VertexId v = start;
  do {
    const GridPoint a = tin.position(v);
    const GridPoint b = tin.position(next[v]);
    const GridPoint c = tin.position(next[next[v]]);
    const bool straight_back = orient(a, b, c) == 0 && points_up(a, b) != points_up(b, c);
    if (orient(a, b, c) < 0 || straight_back) {
      return at_vertex("I4: the domain is not convex at", next[v]);
    }
    rounds += !points_up(a, b) && points_up(b, c) ? 1 : 0;
    v = next[v];
  } while (v != start);
  return rounds == 1 ? std::string()
                     : "I4: the border goes round " + std::to_string(rounds) + " times";
}

__extension__ using Wide = __int128;

/// Twice the area of the triangles of any mesh. One that is not valid may cover the domain many
/// times, which takes 128 bits.
Wide wide_twice_area(const Tin& tin) {
  Wide sum = 0;
  for (const Triangle& t : tin.triangles) {
    if (t.v[0] != kNone) {
      sum += orient(tin.position(t.v[0]), tin.position(t.v[1]), tin.position(t.v[2]));
    }
  }
  return sum;
}

std::string check_border_and_cover(const Tin& tin) {
  std::vector<VertexId> next;
  std::size_t edges = 0;
  if (std::string fault = collect_border(tin, next, edges); !fault.empty()) {
    return fault;
  }
  VertexId start = 0;
  while (start < next.size() && next[start] == kNone) {
    ++start;
  }
  if (start == next.size()) {
    return "I4: there is no border";
  }
  std::size_t walked = 0;
  for (VertexId v = start; walked == 0 || v != start; v = next[v], ++walked) {
    if (walked > edges || next[v] == kNone) {
      return at_vertex("I4: the border is not a closed chain at", v);
    }
  }
  if (walked != edges) {
    return "I4: the border has more than one piece";
  }
  if (std::string fault = check_convex(tin, next, start); !fault.empty()) {
    return fault;
  }
  // The border goes round once and is convex, so twice the area inside of it fits 64 bits.
  std::int64_t border_area = 0;
  const GridPoint origin = tin.position(start);
  for (VertexId v = next[start]; v != start; v = next[v]) {
    border_area += orient(origin, tin.position(v), tin.position(next[v]));
  }
  if (wide_twice_area(tin) != border_area) {
    return "I3: the areas of the triangles do not add up to the domain's";
  }
  const std::size_t triangles = tin.alive_triangles();
  const std::size_t all_edges = (3 * triangles + edges) / 2;
  if (tin.alive_vertices() + triangles != all_edges + 1) {
    return "I3: V - E + F is not 1";
  }
  return {};
}

std::string check_classes(const Tin& tin) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t) || tin.classes[t] == TriangleClass::kVoid) {
      continue;
    }
    for (const VertexId v : tin.triangles[t].v) {
      if (tin.has_height[v] == 0) {
        return at_triangle("I5: a surface triangle has a corner without height:", t);
      }
    }
  }
  return {};
}

std::string check_vertices(const Tin& tin) {
  std::vector<std::uint32_t> uses(tin.vertices.size(), 0);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      for (const VertexId v : tin.triangles[t].v) {
        ++uses[v];
      }
    }
  }
  Star star;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const TriangleId t = tin.vertices[v].triangle;
    if (t == kNone) {
      if (uses[v] != 0) {
        return at_vertex("I6: a removed vertex is in a triangle:", v);
      }
      continue;
    }
    if (t >= tin.triangles.size() || !tin.is_alive(t)) {
      return at_vertex("I6: removed triangle at", v);
    }
    const Triangle& triangle = tin.triangles[t];
    if (triangle.v[corner_of(triangle, v)] != v) {
      return at_vertex("I6: the triangle does not hold", v);
    }
    walk_star(tin, v, star);
    if (star.triangles.size() != uses[v]) {
      return at_vertex("I6: the walk misses triangles at", v);
    }
  }
  return {};
}

}  // namespace

std::int64_t twice_area(const Tin& tin) { return static_cast<std::int64_t>(wide_twice_area(tin)); }

std::string validate(const Tin& tin) {
  for (const auto check : {check_orientation, check_neighbours, check_border_and_cover,
                           check_classes, check_vertices}) {
    if (std::string fault = check(tin); !fault.empty()) {
      return fault;
    }
  }
  return {};
}

}  // namespace ptin
