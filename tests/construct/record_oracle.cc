// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/record_oracle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/mesh/collapse.h"
#include "engine/mesh/validate.h"
#include "tests/construct/surface_oracle.h"

namespace ptin::oracle {

namespace {

/// What a triangle carries.
struct Carried {
  GridBox roi;
  Interval heights;
  double error = 0.0, deviation = 0.0;
  int rank = -1;
};

Carried united(const Carried& a, const Carried& b) {
  return {ptin::united(a.roi, b.roi), ptin::united(a.heights, b.heights),
          std::max(a.error, b.error), std::max(a.deviation, b.deviation), std::max(a.rank, b.rank)};
}

/// A largest value that is known to lie between two.
struct Range {
  double must = 0.0;  ///< At least this: charges, height's unit.
  double may = 0.0;   ///< At most this, rounding aside; residuals too.
  bool zero = true;   ///< Every residual and charge is exactly zero.
};

class Replay {
 public:
  Replay(const TestTerrain& terrain, bool tight)
      : terrain_(terrain),
        tight_(tight),
        heights_(terrain.tile.units.heights),
        tin_(terrain.full),
        carried_(tin_.triangles.size()),
        index_(terrain.samples) {
    for (VertexId v = 0; v < tin_.vertices.size(); ++v) {
      ids_[key_of(tin_.position(v))] = v;
      largest_code_ = std::max(largest_code_, std::abs(terrain.samples[v].code));
    }
    collect_edges();
  }

  std::string run() {
    for (const VertexSplit& r : terrain_.tile.records) {
      if (std::string fault = step(r); !fault.empty()) {
        std::ostringstream message;
        message << terrain_.name << ": the record of the vertex at " << r.u.x << " " << r.u.y
                << " (error " << r.error << ", deviation " << r.deviation << "): " << fault;
        return message.str();
      }
    }
    if (std::string fault = validate(terrain_.tile.tin); !fault.empty()) {
      return terrain_.name + ": " + fault;
    }
    return named_triangles(tin_) == named_triangles(terrain_.tile.tin)
               ? std::string()
               : terrain_.name + ": the mesh is not the one that the records lead to";
  }

 private:
  void collect_edges();
  std::string step(const VertexSplit& r);
  std::string check_site(const VertexSplit& r, std::size_t j) const;
  std::string check_attributes(const VertexSplit& r, const Carried& below) const;
  std::string check_error(const VertexSplit& r, const Carried& below,
                          const std::vector<TriangleId>& fan,
                          const std::vector<std::uint8_t>& surface_before);
  std::string check_deviation(const VertexSplit& r, const Carried& below,
                              const std::vector<TriangleId>& fan) const;
  bool touches_surface(VertexId v, const std::vector<TriangleId>& among) const;
  bool touches_any_surface(VertexId v) const;
  /// What a sample in the wrong class is charged at least.
  double charge(std::size_t sample) const {
    return terrain_.samples[sample].depth * terrain_.slope;
  }
  /// Whether something around the vertex is void or was: then the error may be a charge for the
  /// border's moving, which check_border() looks at from above and from below.
  bool has_charges(const GridBox& box) const;

  const TestTerrain& terrain_;
  bool tight_;
  const HeightEncoding heights_;
  Tin tin_;
  std::vector<Carried> carried_;
  SampleIndex index_;
  std::unordered_map<VertexKey, VertexId> ids_;
  std::optional<EdgeIndex> edges_;       ///< Of the full TIN with surface beside them.
  std::optional<EdgeIndex> data_edges_;  ///< Those with heights at both ends.
  double largest_code_ = 0.0;
  Star star_;
};

void Replay::collect_edges() {
  std::vector<EdgeIndex::Edge> edges, data_edges;
  for (TriangleId t = 0; t < tin_.triangles.size(); ++t) {
    const Corners c = corners_of(tin_, t, heights_);
    for (std::size_t i = 0; i < 3; ++i) {
      const TriangleId n = tin_.triangles[t].n[(i + 2) % 3];
      if (n != kNone && n > t) {
        continue;
      }
      const bool surface = is_surface(tin_, t) || (n != kNone && is_surface(tin_, n));
      if (surface) {
        edges.push_back({c[i], c[(i + 1) % 3]});
      }
      if (tin_.has_height[tin_.triangles[t].v[i]] != 0 &&
          tin_.has_height[tin_.triangles[t].v[(i + 1) % 3]] != 0) {
        data_edges.push_back({c[i], c[(i + 1) % 3]});
      }
    }
  }
  edges_.emplace(std::move(edges));
  data_edges_.emplace(std::move(data_edges));
}

bool Replay::touches_surface(VertexId v, const std::vector<TriangleId>& among) const {
  return std::any_of(among.begin(), among.end(), [&](TriangleId t) {
    const Triangle& triangle = tin_.triangles[t];
    return is_surface(tin_, t) && (triangle.v[0] == v || triangle.v[1] == v || triangle.v[2] == v);
  });
}

bool Replay::touches_any_surface(VertexId v) const {
  Star star;
  walk_star(tin_, v, star);
  return touches_surface(v, star.triangles);
}

std::string Replay::check_site(const VertexSplit& r, std::size_t j) const {
  if (!can_collapse(tin_, star_, j)) {
    return "the collapse is not allowed";
  }
  const CollapseSite site = collapse_site(star_, j);
  unsigned flags = 0;
  const auto add = [&](TriangleId t, unsigned none, unsigned is_void) {
    flags |= t == kNone ? none : (is_surface(tin_, t) ? 0U : is_void);
  };
  add(site.left, VertexSplit::kNoLeft, VertexSplit::kLeftVoid);
  add(site.right, VertexSplit::kNoRight, VertexSplit::kRightVoid);
  const bool has_height = tin_.has_height[site.u] != 0;
  flags |= has_height ? 0U : unsigned{VertexSplit::kVertexVoid};
  if (r.flags != flags) {
    return "wrong flags";
  }
  if (!(r.vl == tin_.position(site.vl)) || !(r.vr == tin_.position(site.vr))) {
    return "wrong vl or vr";
  }
  return r.height == (has_height ? tin_.vertices[site.u].height : 0) ? "" : "wrong height";
}

std::string Replay::check_attributes(const VertexSplit& r, const Carried& below) const {
  if (!(r.roi == below.roi)) {
    return "the roi is not the union of P(u) and what depends on it";
  }
  const Interval interval{heights_.code(r.height_lo), heights_.code(r.height_hi)};
  if (is_empty(below.heights) ? !is_empty(interval) : !(interval == below.heights)) {
    return "the interval of heights is not the union";
  }
  if (r.rank != below.rank + 1) {
    return "the rank is not one more than the largest below";
  }
  return static_cast<double>(r.error) >= below.error &&
                 static_cast<double>(r.deviation) >= below.deviation
             ? ""
             : "error or deviation is smaller than what depends on it";
}

std::string Replay::check_error(const VertexSplit& r, const Carried& below,
                                const std::vector<TriangleId>& fan,
                                const std::vector<std::uint8_t>& surface_before) {
  const Bound bound(r.error, heights_.step);
  Range own;
  std::string fault;
  const auto add = [&](double value, bool surely) {
    own.may = std::max(own.may, value);
    own.must = surely ? std::max(own.must, value) : own.must;
    own.zero &= value == 0.0;
  };
  GridBox box;
  for (const TriangleId t : fan) {
    box = ptin::united(box, box_of_corners(corners_of(tin_, t, heights_)));
  }
  index_.for_each_in(box, [&](std::size_t i) {
    const PlainSample& s = terrain_.samples[i];
    bool here = false, inside = false, in_surface = false, in_void = false;
    for (const TriangleId t : fan) {
      const Corners c = corners_of(tin_, t, heights_);
      if (!in_closed(c, s.position)) {
        continue;
      }
      inside |= here || in_open(c, s.position);  // in two: on a spoke
      here = true;
      if (!is_surface(tin_, t) && s.has_height) {  // an edge that may get surface beside it
        for (std::size_t k = 0; k < 3; ++k) {
          const VertexId a = tin_.triangles[t].v[k], b = tin_.triangles[t].v[(k + 1) % 3];
          const auto gap =
              Gap::of_crossing(c[k], c[(k + 1) % 3], {s.position, s.code}, {s.position, s.code});
          if (gap && tin_.has_height[a] != 0 && tin_.has_height[b] != 0 &&
              side(c[k].position, c[(k + 1) % 3].position, s.position) == 0) {
            own.may = std::max(own.may, static_cast<double>(gap->rough()) * heights_.step);
          }
        }
      }
      in_void |= !is_surface(tin_, t);
      if (is_surface(tin_, t)) {
        in_surface = true;
        if (s.has_height) {
          const Gap gap = Gap::of_sample(c, s.position, s.code);
          if (gap.exceeds(bound)) {
            fault = "the error is too small for the sample at " + std::to_string(s.position.x) +
                    " " + std::to_string(s.position.y);
          }
          if (gap.rough() > 0 && !gap.is_zero()) {
            own.zero = false;
            own.may = std::max(own.may, static_cast<double>(gap.rough()) * heights_.step);
          }
        }
      }
    }
    const bool wrong = s.has_height ? !in_surface : !in_void;
    if (here && wrong && tin_.vertices[i].triangle == kNone) {
      add(charge(i), inside);
    }
  });
  for (std::size_t k = 0; k < star_.link.size(); ++k) {
    const VertexId v = star_.link[k];
    if (tin_.has_height[v] != 0 && surface_before[k] != 0 && !touches_surface(v, fan)) {
      add(charge(v), !touches_any_surface(v));
    }
  }
  if (!fault.empty()) {
    return fault;
  }
  const auto error = static_cast<double>(r.error);
  if (error < own.must) {
    return "the error is smaller than the charge for a lost sample";
  }
  const double most = std::max(below.error, own.may);
  if (most == 0.0 && own.zero && error != 0.0 && !terrain_.tile.has_voids) {
    return "the error should be exactly zero";
  }
  const double rounding = std::ldexp(largest_code_ * heights_.step, -44);
  return !tight_ || has_charges(box) || error <= most * (1 + 3e-7) + rounding
             ? ""
             : "the error is larger than it needs to be";
}

bool Replay::has_charges(const GridBox& box) const {
  bool found = false;
  for (const TriangleId t : star_.triangles) {
    found |= tin_.classes[t] == TriangleClass::kVoid;
  }
  index_.for_each_in(box, [&](std::size_t i) { found |= terrain_.samples[i].depth < kInfinity; });
  return found;
}

std::string Replay::check_deviation(const VertexSplit& r, const Carried& below,
                                    const std::vector<TriangleId>& fan) const {
  const Bound bound(r.deviation, heights_.step);
  double most = std::max(below.deviation, 0.0);
  bool too_small = false;
  for (const TriangleId t : fan) {
    const Corners c = corners_of(tin_, t, heights_);
    for (std::size_t i = 0; is_surface(tin_, t) && i < 3; ++i) {
      const Corner& from = c[i];
      const Corner& to = c[(i + 1) % 3];
      const GridBox box = ptin::united(box_of(from.position), to.position);
      edges_->for_each_near(box, [&](const EdgeIndex::Edge& e) {
        const auto gap = Gap::of_crossing(from, to, e[0], e[1]);
        too_small |= gap && gap->exceeds(bound);
      });
      data_edges_->for_each_near(box, [&](const EdgeIndex::Edge& e) {
        const auto gap = Gap::of_crossing(from, to, e[0], e[1]);
        most = gap ? std::max(most, static_cast<double>(gap->rough()) * heights_.step) : most;
      });
    }
  }
  for (const TriangleId t : fan) {
    const Corners c = corners_of(tin_, t, heights_);
    index_.for_each_in(box_of_corners(c), [&](std::size_t i) {
      const PlainSample& s = terrain_.samples[i];
      if (is_surface(tin_, t) && s.has_height && in_closed(c, s.position)) {
        const long double gap = Gap::of_sample(c, s.position, s.code).rough();
        most = std::max(most, static_cast<double>(gap) * heights_.step);
      }
    });
  }
  if (too_small) {
    return "the deviation is too small";
  }
  const double rounding = std::ldexp(largest_code_ * heights_.step, -44);
  return !tight_ || static_cast<double>(r.deviation) <= most * (1 + 3e-7) + rounding
             ? ""
             : "the deviation is larger than it needs to be";
}

std::string Replay::step(const VertexSplit& r) {
  const auto u = ids_.find(key_of(r.u));
  if (u == ids_.end() || tin_.vertices[u->second].triangle == kNone) {
    return "its vertex is not there";
  }
  walk_star(tin_, u->second, star_);
  std::size_t j = 0;
  while (j < star_.degree() && !(tin_.position(star_.link[j]) == r.w)) {
    ++j;
  }
  if (j == star_.degree()) {
    return "w is not a neighbour";
  }
  if (std::string fault = check_site(r, j); !fault.empty()) {
    return fault;
  }
  Carried all;
  const auto add_vertex = [&](VertexId v) {
    all.roi = ptin::united(all.roi, tin_.position(v));
    if (tin_.has_height[v] != 0) {
      all.heights = ptin::united(all.heights, heights_.code(tin_.vertices[v].height));
    }
  };
  add_vertex(u->second);
  std::for_each(star_.link.begin(), star_.link.end(), add_vertex);
  std::vector<std::uint8_t> surface_before;
  for (const VertexId v : star_.link) {
    surface_before.push_back(touches_surface(v, star_.triangles) ? 1 : 0);
  }
  for (const TriangleId t : star_.triangles) {
    all = united(all, carried_[t]);
  }
  if (std::string fault = check_attributes(r, all); !fault.empty()) {
    return fault;
  }
  const CollapseSite site = collapse(tin_, star_, j);
  std::vector<TriangleId> fan;
  for (std::size_t i = 0; i < star_.triangles.size(); ++i) {  // round w from vl to vr
    const TriangleId t = star_.triangles[(j + (star_.closed ? 1 : 0) + i) % star_.triangles.size()];
    if (star_.closed ? tin_.is_alive(t) : tin_.is_alive(star_.triangles[i])) {
      fan.push_back(star_.closed ? t : star_.triangles[i]);
    }
  }
  if (site.w != star_.link[j] || fan.empty()) {
    return "no fan";
  }
  for (const TriangleId t : fan) {
    if (is_surface(tin_, t) && tin_.has_height[site.w] == 0) {
      return "a surface triangle gets a corner without height";
    }
  }
  std::string fault = check_error(r, all, fan, surface_before);
  if (fault.empty()) {
    fault = check_deviation(r, all, fan);
  }
  for (const TriangleId t : fan) {
    carried_[t] = {r.roi,
                   {heights_.code(r.height_lo), heights_.code(r.height_hi)},
                   r.error,
                   r.deviation,
                   r.rank};
  }
  return fault;
}

}  // namespace

std::string check_records(const TestTerrain& terrain, bool tight) {
  return Replay(terrain, tight).run();
}

}  // namespace ptin::oracle
