// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/surface_oracle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <unordered_map>

#include "engine/mesh/split.h"
#include "tests/construct/border_oracle.h"

namespace ptin::oracle {

SampleIndex::SampleIndex(const std::vector<PlainSample>& samples) : samples_(&samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (rows_.empty() || rows_.back() != samples[i].position.y) {
      rows_.push_back(samples[i].position.y);
      first_of_row_.push_back(i);
    }
  }
  first_of_row_.push_back(samples.size());
}

void SampleIndex::for_each_in(const GridBox& box,
                              const std::function<void(std::size_t)>& visit) const {
  auto row = std::lower_bound(rows_.begin(), rows_.end(), box.min_y);
  for (; row != rows_.end() && *row <= box.max_y; ++row) {
    const auto r = static_cast<std::size_t>(row - rows_.begin());
    const auto begin = samples_->begin() + static_cast<std::ptrdiff_t>(first_of_row_[r]);
    const auto end = samples_->begin() + static_cast<std::ptrdiff_t>(first_of_row_[r + 1]);
    auto s = std::lower_bound(begin, end, box.min_x, [](const PlainSample& a, std::int32_t x) {
      return a.position.x < x;
    });
    for (; s != end && s->position.x <= box.max_x; ++s) {
      visit(static_cast<std::size_t>(s - samples_->begin()));
    }
  }
}

EdgeIndex::EdgeIndex(std::vector<Edge> edges) : edges_(std::move(edges)) {
  std::sort(edges_.begin(), edges_.end(),
            [](const Edge& a, const Edge& b) { return lowest(a) < lowest(b); });
  for (const Edge& e : edges_) {
    tallest_ = std::max(tallest_, std::abs(std::int64_t{e[0].position.y} - e[1].position.y));
  }
}

std::vector<EdgeIndex::Edge>::const_iterator EdgeIndex::first_from(std::int64_t y) const {
  return std::lower_bound(edges_.begin(), edges_.end(), y,
                          [](const Edge& e, std::int64_t v) { return lowest(e) < v; });
}

Corners corners_of(const Tin& tin, TriangleId t, const HeightEncoding& heights) {
  Corners corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexId v = tin.triangles[t].v[i];
    corners[i] = {tin.position(v),
                  tin.has_height[v] != 0 ? heights.code(tin.vertices[v].height) : 0.0};
  }
  return corners;
}

GridBox box_of_corners(const Corners& t) {
  GridBox box;
  for (const Corner& c : t) {
    box = united(box, c.position);
  }
  return box;
}

bool is_surface(const Tin& tin, TriangleId t) {
  return tin.is_alive(t) && tin.classes[t] == TriangleClass::kSurface;
}

Tin refined(const Tin& coarse, const std::vector<VertexSplit>& records,
            const RecordPredicate& predicate, std::string& fault, std::mt19937_64* shuffle) {
  Tin tin = coarse;
  std::vector<const VertexSplit*> chosen;
  for (const VertexSplit& r : records) {
    if (predicate(r)) {
      chosen.push_back(&r);
    }
  }
  if (shuffle != nullptr) {
    std::shuffle(chosen.begin(), chosen.end(), *shuffle);
  }
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const VertexSplit* a, const VertexSplit* b) { return a->rank > b->rank; });
  std::unordered_map<VertexKey, VertexId> ids;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    ids[key_of(tin.position(v))] = v;
  }
  const auto class_of = [](const VertexSplit& r, unsigned flag) {
    return (r.flags & flag) != 0 ? TriangleClass::kVoid : TriangleClass::kSurface;
  };
  for (const VertexSplit* r : chosen) {
    const VertexId w = ids.at(key_of(r->w));
    const SplitSite site{ids.at(key_of(r->u)),
                         w,
                         ids.at(key_of(r->vl)),
                         ids.at(key_of(r->vr)),
                         (r->flags & VertexSplit::kNoLeft) == 0,
                         (r->flags & VertexSplit::kNoRight) == 0,
                         class_of(*r, VertexSplit::kLeftVoid),
                         class_of(*r, VertexSplit::kRightVoid)};
    if (tin.vertices[w].triangle == kNone || tin.vertices[site.u].triangle != kNone ||
        !split(tin, site).applied) {
      fault = "the split of the vertex at " + std::to_string(r->u.x) + " " +
              std::to_string(r->u.y) + " does not fit";
      return tin;
    }
  }
  return tin;
}

std::vector<NamedTriangle> named_triangles(const Tin& tin) {
  std::vector<NamedTriangle> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    std::array<VertexKey, 3> k{};
    for (std::size_t i = 0; i < 3; ++i) {
      k[i] = key_of(tin.position(tin.triangles[t].v[i]));
    }
    std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
    all.emplace_back(k[0], k[1], k[2], tin.classes[t]);
  }
  std::sort(all.begin(), all.end());
  return all;
}

namespace {

std::string at(GridPoint p) { return std::to_string(p.x) + " " + std::to_string(p.y); }

struct Seen {
  bool in_closed_surface = false;
  bool in_closed_void = false;
  std::string fault;
};

}  // namespace

std::string check_samples(const TestTerrain& terrain, const Tin& tin, double tolerance) {
  const HeightEncoding& heights = terrain.tile.units.heights;
  const Bound bound(tolerance, heights.step);
  const SampleIndex index(terrain.samples);
  std::vector<Seen> seen(terrain.samples.size());
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    const bool surface = is_surface(tin, t);
    const Corners corners = corners_of(tin, t, heights);
    index.for_each_in(box_of_corners(corners), [&](std::size_t i) {
      const PlainSample& s = terrain.samples[i];
      if (!in_closed(corners, s.position)) {
        return;
      }
      (surface ? seen[i].in_closed_surface : seen[i].in_closed_void) = true;
      if (surface && s.has_height && Gap::of_sample(corners, s.position, s.code).exceeds(bound)) {
        seen[i].fault = "is further from the surface";
      }
    });
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const PlainSample& s = terrain.samples[i];
    const bool wrong = s.has_height ? !seen[i].in_closed_surface : !seen[i].in_closed_void;
    if (wrong && !(s.depth * terrain.slope <= tolerance)) {
      seen[i].fault = s.has_height ? "is deep inside and void" : "is deep outside and surface";
    }
    if (!seen[i].fault.empty()) {
      std::ostringstream message;
      message << terrain.name << ": at tolerance " << tolerance << " the sample at "
              << at(s.position) << " (depth " << s.depth << ") " << seen[i].fault;
      return message.str();
    }
  }
  return check_border(terrain, tin, tolerance);
}

namespace {

/// The edges of surface triangles, each as two corners.
std::vector<std::array<Corner, 2>> surface_edges(const Tin& tin, const HeightEncoding& heights) {
  std::vector<std::array<Corner, 2>> edges;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (is_surface(tin, t)) {
      const Corners c = corners_of(tin, t, heights);
      for (std::size_t i = 0; i < 3; ++i) {
        const TriangleId n =
            tin.triangles[t].n[(i + 2) % 3];  // across the edge from c[i] to the next
        if (n == kNone || n > t || !is_surface(tin, n)) {
          edges.push_back({c[i], c[(i + 1) % 3]});
        }
      }
    }
  }
  return edges;
}

}  // namespace

std::string check_deviation(const TestTerrain& terrain, const Tin& tin, double deviation) {
  const HeightEncoding& heights = terrain.tile.units.heights;
  const Bound bound(deviation, heights.step);
  const EdgeIndex full(surface_edges(terrain.full, heights));
  std::string fault;
  for (const auto& e : surface_edges(tin, heights)) {
    full.for_each_near(united(box_of(e[0].position), e[1].position), [&](const auto& f) {
      const std::optional<Gap> gap = Gap::of_crossing(e[0], e[1], f[0], f[1]);
      if (gap && gap->exceeds(bound)) {
        std::ostringstream message;
        message << terrain.name << ": the edge from " << at(e[0].position) << " to "
                << at(e[1].position) << " is " << gap->rough() * heights.step
                << " from the full surface, not " << deviation;
        fault = message.str();
      }
    });
  }
  const SampleIndex index(terrain.samples);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (is_surface(tin, t)) {
      const Corners corners = corners_of(tin, t, heights);
      index.for_each_in(box_of_corners(corners), [&](std::size_t i) {
        const PlainSample& s = terrain.samples[i];
        if (s.has_height && in_closed(corners, s.position) &&
            Gap::of_sample(corners, s.position, s.code).exceeds(bound)) {
          fault = terrain.name + ": the sample at " + at(s.position) + " exceeds the deviation";
        }
      });
    }
  }
  return fault;
}

namespace {

/// The surface at a point in double precision; nothing in voids. By looking at every triangle.
std::optional<long double> surface_at(const Tin& tin, const HeightEncoding& heights, long double x,
                                      long double y) {
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (!tin.is_alive(t)) {
      continue;
    }
    const Corners c = corners_of(tin, t, heights);
    long double sum = 0, weights = 0;
    bool inside = true;
    for (std::size_t i = 0; i < 3 && inside; ++i) {
      const GridPoint a = c[(i + 1) % 3].position, b = c[(i + 2) % 3].position;
      const long double weight = (a.x - x) * (b.y - y) - (b.x - x) * (a.y - y);
      inside = weight > 0;
      sum += weight * static_cast<long double>(c[i].code);
      weights += weight;
    }
    if (inside) {
      return tin.classes[t] == TriangleClass::kSurface ? std::optional(sum / weights)
                                                       : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string check_random_points(const TestTerrain& terrain, const Tin& tin, double deviation,
                                int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  GridBox bounds;
  for (const PlainSample& s : terrain.samples) {
    bounds = united(bounds, s.position);
  }
  const HeightEncoding& heights = terrain.tile.units.heights;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < count; ++i) {
    const long double x = bounds.min_x + unit(random) * (bounds.max_x - bounds.min_x);
    const long double y = bounds.min_y + unit(random) * (bounds.max_y - bounds.min_y);
    const auto is = surface_at(tin, heights, x, y);
    const auto should = surface_at(terrain.full, heights, x, y);
    if (is && should) {
      const long double gap = std::abs(*is - *should) * heights.step;
      if (gap > deviation + 1e-9L * (1 + deviation + std::abs(*is) + std::abs(*should))) {
        std::ostringstream message;
        message << terrain.name << ": at " << x << " " << y << " the surface is off by " << gap
                << ", not " << deviation;
        return message.str();
      }
    }
  }
  return {};
}

}  // namespace ptin::oracle
