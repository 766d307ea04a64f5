// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/first_pass.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/construct/collapse/edge_middles.h"
#include "engine/construct/collapse/right_triangles.h"
#include "engine/construct/measure/fan_error.h"
#include "engine/construct/measure/sample_blocks.h"
#include "engine/construct/measure/saturation.h"
#include "engine/mesh/triangle_holds.h"

namespace ptin {

namespace {

/// The heights and cells of a full TIN over a raster.
struct Samples {
  std::vector<double> codes;
  std::vector<std::uint8_t> rising;
  SampleGrid grid;

  Samples(const Tile& full, const GridBox& box) {
    const Tin& tin = full.tin;
    grid.width = box.max_x - box.min_x + 1;
    grid.height = box.max_y - box.min_y + 1;
    codes.resize(tin.vertices.size());
    rising.resize(tin.vertices.size());
    for (std::size_t v = 0; v < codes.size(); ++v) {
      codes[v] = full.units.heights.code(tin.vertices[v].height);
    }
    std::size_t cell = 0;
    for (std::int32_t y = 0; y + 1 < grid.height; ++y) {
      for (std::int32_t x = 0; x + 1 < grid.width; ++x, ++cell) {
        // The last corner of the first half of a cell is its upper right one where the cut rises,
        // else its upper left one.
        const std::size_t last = tin.triangles[2 * cell].v[2];
        rising[grid.at(x, y)] = last == grid.at(x + 1, y + 1) ? 1 : 0;
      }
    }
    grid.codes = codes;
    grid.valid = tin.has_height;
    grid.rising = rising;
  }
};

/// The plane of a right triangle, relative to its first corner. Twice the area is a power of two,
/// so slopes between whole codes are exact.
struct Plane {
  GridPoint at;
  double code, slope_x, slope_y;

  Plane(const Tile& tile, const Triangle& triangle) {
    const auto code_of = [&](int i) {
      return tile.units.heights.code(tile.tin.vertices[triangle.v[i]].height);
    };
    at = tile.tin.position(triangle.v[0]);
    code = code_of(0);
    const GridPoint b = tile.tin.position(triangle.v[1]), c = tile.tin.position(triangle.v[2]);
    const double bx = b.x - at.x, by = b.y - at.y, bz = code_of(1) - code;
    const double cx = c.x - at.x, cy = c.y - at.y, cz = code_of(2) - code;
    const double area = bx * cy - by * cx;
    slope_x = (bz * cy - cz * by) / area;
    slope_y = (cz * bx - bz * cx) / area;
  }
  /// A bound on |residual| of a sample, in codes; tight up to rounding.
  /// @param exact  Codes are whole numbers: no rounding is added.
  [[nodiscard]] double residual(GridPoint p, double sample, bool exact) const noexcept {
    const double z = sample - code;
    const double x = slope_x * static_cast<double>(p.x - at.x);
    const double y = slope_y * static_cast<double>(p.y - at.y);
    const double size = std::abs(z) + std::abs(x) + std::abs(y);
    return std::abs(z - (x + y)) + (exact ? 0.0 : 0x1p-47 * size);
  }
};

class FirstPass {
 public:
  FirstPass(const Tile& full, const FullSurface& surface, const GridBox& box)
      : full_(full), surface_(surface), box_(box), samples_(full, box) {
    for (const CarriedState& carried : full.carried) {
      for (const Sample& s : full.samples.samples(carried.samples)) {
        directed_.emplace(key_of(s.position), s);
      }
    }
  }

  Tile run(const SurroundingSamples& around, double tolerance);

 private:
  [[nodiscard]] std::vector<std::uint8_t> needed_within(const SurroundingSamples& around,
                                                        double tolerance) const;
  void take_vertices(const std::vector<std::uint8_t>& needed);
  void take_triangles(const std::vector<RightTriangle>& triangles);
  void link();
  [[nodiscard]] double gap_along(TriangleId t, int side) const;
  void collect(TriangleId t);
  [[nodiscard]] Interval codes_of(const Triangle& triangle) const;
  void record(TriangleId t);
  void collect_directed(TriangleId t);
  void store(TriangleId t);

  const Tile& full_;
  const FullSurface& surface_;
  const GridBox& box_;
  Samples samples_;
  std::vector<std::uint8_t> is_free_;  ///< 1 for a sample that is no vertex and in no list yet.
  std::vector<VertexId> place_;        ///< The vertex of each sample; kNone for the others.
  Tile tile_;
  std::vector<double> gap_;  ///< The largest gap along each triangle's edges, codes.
  std::unordered_multimap<VertexKey, Sample> directed_;  ///< Witnesses of triangles, by vertex.
  std::vector<Sample> list_;                             ///< Samples of the triangle at hand.
  double worst_ = 0.0;                                   ///< The largest residual in list_, codes.
};

/// The samples that stay as corners.
std::vector<std::uint8_t> FirstPass::needed_within(const SurroundingSamples& around,
                                                   double tolerance) const {
  if (around.heights.empty()) {
    return needed_corners({samples_.grid, samples_.grid}, tolerance);
  }
  const GridBox part{std::max(box_.min_x - kDecidingMargin, around.box.min_x),
                     std::max(box_.min_y - kDecidingMargin, around.box.min_y),
                     std::min(box_.max_x + kDecidingMargin, around.box.max_x),
                     std::min(box_.max_y + kDecidingMargin, around.box.max_y)};
  const auto pitch = static_cast<std::size_t>(around.box.max_x - around.box.min_x + 1);
  const auto columns = static_cast<std::size_t>(part.max_x - part.min_x + 1);
  std::vector<double> codes;
  std::vector<std::uint8_t> valid;
  for (std::int32_t y = part.min_y; y <= part.max_y; ++y) {
    const std::size_t first = static_cast<std::size_t>(y - around.box.min_y) * pitch +
                              static_cast<std::size_t>(part.min_x - around.box.min_x);
    for (std::size_t i = first; i < first + columns; ++i) {
      codes.push_back(full_.units.heights.code(around.heights[i]));
      valid.push_back(around.valid[i]);
    }
  }
  SampleGrid outer;
  outer.codes = codes;
  outer.valid = valid;
  outer.width = part.max_x - part.min_x + 1;
  outer.height = part.max_y - part.min_y + 1;
  return needed_corners({samples_.grid, outer, box_.min_x - part.min_x, box_.min_y - part.min_y},
                        tolerance);
}

Tile FirstPass::run(const SurroundingSamples& around, double tolerance) {
  tile_.units = full_.units;
  tile_.samples_fill_grid = true;
  const std::vector<std::uint8_t> needed = needed_within(around, tolerance);
  take_vertices(needed);
  take_triangles(right_triangles(samples_.grid, needed));
  link();
  for (TriangleId t = 0; t < tile_.tin.triangles.size(); ++t) {
    collect(t);
    if (!list_.empty() || gap_[t] > 0.0) {
      record(t);
    }
    collect_directed(t);
    if (!list_.empty()) {
      store(t);
    }
  }
  return std::move(tile_);
}

void FirstPass::take_vertices(const std::vector<std::uint8_t>& needed) {
  place_.assign(needed.size(), kNone);
  is_free_.resize(needed.size());
  for (std::size_t v = 0; v < needed.size(); ++v) {
    is_free_[v] = needed[v] == 0 ? 1 : 0;
    if (needed[v] != 0) {
      place_[v] = static_cast<VertexId>(tile_.tin.vertices.size());
      tile_.tin.vertices.push_back(full_.tin.vertices[v]);
      tile_.tin.has_height.push_back(full_.tin.has_height[v]);
    }
  }
}

void FirstPass::take_triangles(const std::vector<RightTriangle>& triangles) {
  Tin& tin = tile_.tin;
  tin.triangles.reserve(triangles.size());
  for (const RightTriangle& t : triangles) {
    tin.triangles.push_back({{place_[t[0]], place_[t[1]], place_[t[2]]}, {kNone, kNone, kNone}});
    const bool surface = std::all_of(t.begin(), t.end(),
                                     [&](std::uint32_t v) { return samples_.grid.valid[v] != 0; });
    tin.classes.push_back(surface ? TriangleClass::kSurface : TriangleClass::kVoid);
  }
}

/// Links neighbours, measures the gaps along edges, and starts the tile.
void FirstPass::link() {
  Tin& tin = tile_.tin;
  gap_.assign(tin.triangles.size(), 0.0);
  EdgeMiddles middles(box_);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const EdgeMiddles::Side other = middles.match(tin, {t, i});
      if (other.triangle != kNone) {
        tin.triangles[t].n[i] = other.triangle;
        tin.triangles[other.triangle].n[other.side] = t;
      }
    }
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const TriangleId beyond = tin.triangles[t].n[i];
      if (beyond == kNone || beyond > t) {  // once for each edge, on the window's sides too
        const double gap = gap_along(t, i);
        gap_[t] = std::max(gap_[t], gap);
        if (beyond != kNone) {
          gap_[beyond] = std::max(gap_[beyond], gap);
        }
      }
    }
  }
  point_vertices(tin);
  start_tile(tile_, nullptr);
  for (std::size_t v = 0; v < place_.size(); ++v) {
    if (place_[v] != kNone) {
      VertexState& state = tile_.vertex_state[place_[v]];
      state.reach = full_.vertex_state[v].reach;
      state.locked = full_.vertex_state[v].locked;
    }
  }
}

/// The gap between an edge and the full surface, in codes; 0 along an edge of a cell, which is one
/// of the full TIN, and at an end without a height.
double FirstPass::gap_along(TriangleId t, int side) const {
  const Tin& tin = tile_.tin;
  const VertexId a = tin.triangles[t].v[next_corner(side)];
  const VertexId b = tin.triangles[t].v[previous_corner(side)];
  const GridPoint p = tin.position(a), q = tin.position(b);
  if (std::abs(p.x - q.x) + std::abs(p.y - q.y) == 1 || tin.has_height[a] == 0 ||
      tin.has_height[b] == 0) {
    return 0.0;
  }
  const auto code = [&](VertexId v) { return tile_.units.heights.code(tin.vertices[v].height); };
  return surface_.largest_gap({p, code(a)}, {q, code(b)});
}

/// Takes the free samples in a triangle to list_, the one with the largest residual first.
void FirstPass::collect(TriangleId t) {
  list_.clear();
  worst_ = 0.0;
  const Triangle& triangle = tile_.tin.triangles[t];
  GridBox box;
  for (const VertexId v : triangle.v) {
    box = united(box, tile_.tin.position(v));
  }
  if (box.max_x - box.min_x <= 1 && box.max_y - box.min_y <= 1) {
    return;
  }
  const bool is_void = tile_.tin.classes[t] == TriangleClass::kVoid;
  const Plane plane(tile_, triangle);
  for (std::int32_t y = box.min_y; y <= box.max_y; ++y) {
    for (std::int32_t x = box.min_x; x <= box.max_x; ++x) {
      const std::size_t v = samples_.grid.at(x - box_.min_x, y - box_.min_y);
      if (is_free_[v] == 0 || !triangle_holds(tile_.tin, triangle, {x, y})) {
        continue;
      }
      is_free_[v] = 0;
      list_.push_back({{x, y}, full_.tin.vertices[v].height, full_.vertex_state[v].reach});
      const double residual =
          is_void ? 0.0 : plane.residual({x, y}, samples_.codes[v], tile_.units.exact_codes);
      if (residual > worst_) {
        worst_ = residual;
        std::swap(list_.front(), list_.back());
      }
    }
  }
}

/// The codes of the corners of a triangle and of the samples in list_.
Interval FirstPass::codes_of(const Triangle& triangle) const {
  const HeightEncoding& heights = tile_.units.heights;
  Interval codes;
  for (const VertexId v : triangle.v) {
    codes = united(codes, heights.code(tile_.tin.vertices[v].height));
  }
  for (const Sample& s : list_) {
    codes = united(codes, heights.code(s.height));
  }
  return codes;
}

/// Adds to list_ the witnesses that lie in a triangle. The first pass moves no border: the triangle
/// is of their class.
void FirstPass::collect_directed(TriangleId t) {
  if (directed_.empty()) {
    return;
  }
  const Triangle& triangle = tile_.tin.triangles[t];
  const bool is_void = tile_.tin.classes[t] == TriangleClass::kVoid;
  GridBox box;
  for (const VertexId v : triangle.v) {
    box = united(box, tile_.tin.position(v));
  }
  for (std::int32_t y = box.min_y; y <= box.max_y; ++y) {
    for (std::int32_t x = box.min_x; x <= box.max_x; ++x) {
      auto [at, end] = directed_.equal_range(key_of(GridPoint{x, y}));
      while (at != end) {
        const Sample& s = at->second;
        const bool is_own = (s.reach < 0.0F) == is_void;
        if (is_own && triangle_holds(tile_.tin, triangle, s.position, s.direction)) {
          list_.push_back(s);
          at = directed_.erase(at);
        } else {
          ++at;
        }
      }
    }
  }
}

/// Gives the triangle a record that says what it leaves out: the samples in list_.
void FirstPass::record(TriangleId t) {
  const HeightEncoding& heights = tile_.units.heights;
  const Triangle& triangle = tile_.tin.triangles[t];
  VertexSplit r;
  r.error = height_bound(worst_, heights);
  r.deviation = height_bound(std::max(worst_, gap_[t]), heights);
  const bool is_void = tile_.tin.classes[t] == TriangleClass::kVoid;
  std::tie(r.height_lo, r.height_hi) =
      height_bits(is_void ? Interval{} : codes_of(triangle), heights);
  r.u = r.w = tile_.tin.position(triangle.v[0]);
  r.vl = tile_.tin.position(triangle.v[1]);
  r.vr = tile_.tin.position(triangle.v[2]);
  r.roi = united(united(box_of(r.u), r.vl), r.vr);

  CarriedState& carried = tile_.carried[t];
  carry_record(carried, r, static_cast<std::uint32_t>(tile_.records.size()));
  tile_.records.push_back(r);
}

/// Gives the triangle the samples in list_.
void FirstPass::store(TriangleId t) {
  CarriedState& carried = tile_.carried[t];
  const bool is_void = tile_.tin.classes[t] == TriangleClass::kVoid;
  carried.holds_heights = !is_void;
  carried.holds_voids = is_void;
  GridBox box;
  for (const VertexId v : tile_.tin.triangles[t].v) {
    box = united(box, tile_.tin.position(v));
  }
  join_where_alike(list_, 2.0 * static_cast<double>(half_perimeter(box)));
  carried.samples = tile_.samples.take(static_cast<std::uint32_t>(list_.size()));
  std::copy(list_.begin(), list_.end(), tile_.samples.samples(carried.samples).begin());
}

}  // namespace

void run_first_pass(Tile& tile, const FullSurface& full, const GridBox& box,
                    const SurroundingSamples& around, double tolerance) {
  tile = FirstPass(tile, full, box).run(around, tolerance);
}

}  // namespace ptin
