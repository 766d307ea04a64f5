// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/border_oracle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "engine/geometry/infinity.h"

namespace ptin::oracle {

namespace {

PlanPoint plan(GridPoint p) { return {static_cast<double>(p.x), static_cast<double>(p.y)}; }

PlanPoint between(PlanPoint a, PlanPoint b, double t) {
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t};
}

double distance_to_side(PlanPoint p, const std::array<PlanPoint, 2>& s) {
  const double ux = s[1].x - s[0].x, uy = s[1].y - s[0].y;
  const double t =
      std::clamp(((p.x - s[0].x) * ux + (p.y - s[0].y) * uy) / (ux * ux + uy * uy), 0.0, 1.0);
  const PlanPoint q = between(s[0], s[1], t);
  return std::hypot(p.x - q.x, p.y - q.y);
}

/// Looks triangles up by points.
class Classes {
 public:
  explicit Classes(const Tin& tin) : tin_(tin) {
    for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
      if (tin.is_alive(t)) {
        GridBox box;
        for (const VertexId v : tin.triangles[t].v) {
          box = united(box, tin.position(v));
        }
        all_.push_back({t, box});
      }
    }
    std::sort(all_.begin(), all_.end(),
              [](const Entry& a, const Entry& b) { return a.box.min_y < b.box.min_y; });
    for (const Entry& e : all_) {
      tallest_ = std::max(tallest_, e.box.max_y - e.box.min_y);
    }
  }
  /// The triangle whose inside holds p; kNone on an edge.
  [[nodiscard]] TriangleId at(PlanPoint p) const {
    auto e = std::lower_bound(all_.begin(), all_.end(), p.y - tallest_,
                              [](const Entry& entry, double y) { return entry.box.min_y < y; });
    for (; e != all_.end() && e->box.min_y <= p.y; ++e) {
      if (p.x < e->box.min_x || p.x > e->box.max_x || p.y > e->box.max_y) {
        continue;
      }
      bool inside = true;
      for (int i = 0; i < 3 && inside; ++i) {
        const PlanPoint a = plan(tin_.position(tin_.triangles[e->t].v[i]));
        const PlanPoint b = plan(tin_.position(tin_.triangles[e->t].v[(i + 1) % 3]));
        inside = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0.0;
      }
      if (inside) {
        return e->t;
      }
    }
    return kNone;
  }
  [[nodiscard]] TriangleClass of(TriangleId t) const { return tin_.classes[t]; }

 private:
  struct Entry {
    TriangleId t;
    GridBox box;
  };
  const Tin& tin_;
  std::vector<Entry> all_;
  std::int32_t tallest_ = 0;
};

using Leaders = std::vector<std::size_t>;

std::size_t leader(Leaders& l, std::size_t i) {
  while (l[i] != i) {
    i = l[i] = l[l[i]];
  }
  return i;
}

/// The region of surface of each vertex: connected by sides and by vertices.
Leaders regions_of(const Tin& tin) {
  Leaders l(tin.vertices.size());
  std::iota(l.begin(), l.end(), 0U);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t) && tin.classes[t] == TriangleClass::kSurface) {
      for (const VertexId v : tin.triangles[t].v) {
        l[leader(l, v)] = leader(l, tin.triangles[t].v[0]);
      }
    }
  }
  for (std::size_t v = 0; v < l.size(); ++v) {
    l[v] = leader(l, v);
  }
  return l;
}

/// Groups of regions of the full TIN that are joined by steps of at most `step`.
std::map<std::size_t, std::size_t> groups_of(const Tin& full, const Leaders& regions, double step) {
  std::map<std::size_t, std::vector<std::array<PlanPoint, 2>>> sides;
  for (TriangleId t = 0; t < full.triangles.size(); ++t) {
    if (full.classes[t] != TriangleClass::kSurface) {
      continue;
    }
    const Triangle& triangle = full.triangles[t];
    auto& own = sides[regions[triangle.v[0]]];
    for (int i = 0; i < 3; ++i) {
      const TriangleId n = triangle.n[i];
      if (n == kNone || full.classes[n] == TriangleClass::kVoid) {
        own.push_back({plan(full.position(triangle.v[(i + 1) % 3])),
                       plan(full.position(triangle.v[(i + 2) % 3]))});
      }
    }
  }
  std::map<std::size_t, std::size_t> group;
  for (const auto& [region, own] : sides) {
    group[region] = region;
  }
  for (const auto& [a, of_a] : sides) {
    for (const auto& [b, of_b] : sides) {
      if (a >= b || group[a] == group[b]) {
        continue;
      }
      bool near = false;
      for (const auto& s : of_a) {
        for (const auto& t : of_b) {
          near = near || distance_to_side(s[0], t) <= step || distance_to_side(s[1], t) <= step ||
                 distance_to_side(t[0], s) <= step || distance_to_side(t[1], s) <= step;
        }
      }
      if (near) {
        const std::size_t from = group[b], to = group[a];
        for (auto& [region, g] : group) {
          g = g == from ? to : g;
        }
      }
    }
  }
  return group;
}

std::string at(PlanPoint p) {
  std::ostringstream text;
  text << p.x << " " << p.y;
  return text.str();
}

/// Points within a triangle: its middle, and one near each corner.
std::array<PlanPoint, 4> points_in(const Tin& tin, TriangleId t) {
  std::array<PlanPoint, 3> c{};
  for (int i = 0; i < 3; ++i) {
    c[i] = plan(tin.position(tin.triangles[t].v[i]));
  }
  const PlanPoint middle{(c[0].x + c[1].x + c[2].x) / 3, (c[0].y + c[1].y + c[2].y) / 3};
  return {middle, between(c[0], middle, 1e-6), between(c[1], middle, 1e-6),
          between(c[2], middle, 1e-6)};
}

std::string check_regions(const TestTerrain& terrain, const Tin& tin, const Classes& classes,
                          double moved) {
  const Tin& full = terrain.full;
  const Leaders before = regions_of(full), after = regions_of(tin);
  const auto group = groups_of(full, before, moved);
  std::map<std::size_t, std::set<std::size_t>> joined;  // region after -> groups before
  std::set<std::size_t> kept;
  for (TriangleId t = 0; t < full.triangles.size(); ++t) {
    if (full.classes[t] != TriangleClass::kSurface) {
      continue;
    }
    const std::size_t own = group.at(before[full.triangles[t].v[0]]);
    for (const PlanPoint p : points_in(full, t)) {
      const TriangleId found = classes.at(p);
      if (found != kNone && classes.of(found) == TriangleClass::kSurface) {
        kept.insert(own);
        joined[after[tin.triangles[found].v[0]]].insert(own);
      }
    }
  }
  for (const auto& [region, groups] : joined) {
    if (groups.size() > 1) {
      return "two regions of surface farther apart than " + std::to_string(moved) + " are joined";
    }
  }
  for (const auto& [region, own] : group) {
    if (!kept.contains(own)) {
      return "a region of surface farther than " + std::to_string(moved) + " from others is lost";
    }
  }
  return {};
}

}  // namespace

Border::Border(const Tin& tin) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; tin.is_alive(t) && tin.classes[t] == TriangleClass::kSurface && i < 3; ++i) {
      const TriangleId n = tin.triangles[t].n[i];
      if (n != kNone && tin.classes[n] == TriangleClass::kVoid) {
        sides_.push_back({plan(tin.position(tin.triangles[t].v[(i + 1) % 3])),
                          plan(tin.position(tin.triangles[t].v[(i + 2) % 3]))});
      }
    }
  }
}

double Border::distance(PlanPoint p) const {
  double least = kInfinity;
  for (const auto& s : sides_) {
    least = std::min(least, distance_to_side(p, s));
  }
  return least;
}

double Border::length() const {
  double sum = 0.0;
  for (const auto& s : sides_) {
    sum += std::hypot(s[1].x - s[0].x, s[1].y - s[0].y);
  }
  return sum;
}

void measure_depths(TestTerrain& terrain) {
  const Border border(terrain.full);
  for (PlainSample& s : terrain.samples) {
    s.depth = border.distance(plan(s.position));
  }
}

std::string check_border(const TestTerrain& terrain, const Tin& tin, double tolerance) {
  const Border before(terrain.full), after(tin);
  if (before.sides().empty() && after.sides().empty()) {
    return {};
  }
  const double rounding = 0x1p-50 * kGridMax;  // of coordinates in doubles
  const double moved = tolerance / terrain.slope * (1.0 + 1e-9) + rounding;
  const std::string start = terrain.name + ": at tolerance " + std::to_string(tolerance) + " ";
  const auto check_along = [&](const Border& from, const Border& to, int steps,
                               const char* which) -> std::string {
    for (const auto& s : from.sides()) {
      for (int i = 0; i <= steps; ++i) {
        const PlanPoint p = between(s[0], s[1], static_cast<double>(i) / steps);
        if (const double d = to.distance(p); d > moved) {
          return start + "the border at " + at(p) + which + std::to_string(d);
        }
      }
    }
    return {};
  };
  std::string fault = check_along(before, after, 4, " moves by ");
  fault = fault.empty() ? check_along(after, before, 16, " comes from ") : fault;
  const Classes classes(tin);
  for (TriangleId t = 0; t < terrain.full.triangles.size() && fault.empty(); ++t) {
    for (const PlanPoint p : points_in(terrain.full, t)) {
      const TriangleId found = classes.at(p);
      if (found != kNone && classes.of(found) != terrain.full.classes[t] &&
          before.distance(p) > moved) {
        return start + "the point at " + at(p) + " changes its class";
      }
    }
  }
  return fault.empty() ? check_regions(terrain, tin, classes, moved) : fault;
}

}  // namespace ptin::oracle
