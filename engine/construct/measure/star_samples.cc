// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/star_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/construct/measure/saturation.h"

namespace ptin {

namespace {

template <HeightType type>
double code_of(HeightBits bits) noexcept {
  return type == HeightType::int32 ? static_cast<double>(std::bit_cast<std::int32_t>(bits))
                                   : static_cast<double>(std::bit_cast<float>(bits));
}

template <HeightType type>
void gather_link(const Tile& tile, GridPoint origin, double origin_code, StarSamples& out) {
  const std::size_t degree = out.star.degree();
  out.link_x.resize(degree);
  out.link_y.resize(degree);
  out.link_z.resize(degree);
  double largest_xy = 0.0;
  double largest_z = 0.0;
  for (std::size_t i = 0; i < degree; ++i) {
    const Vertex& v = tile.tin.vertices[out.star.link[i]];
    const bool has_height = !tile.has_voids || tile.tin.has_height[out.star.link[i]] != 0;
    const auto x = static_cast<double>(v.position.x - origin.x);
    const auto y = static_cast<double>(v.position.y - origin.y);
    const double z = has_height ? code_of<type>(v.height) - origin_code : 0.0;
    out.link_x[i] = x;
    out.link_y[i] = y;
    out.link_z[i] = z;
    largest_xy = std::max({largest_xy, std::abs(x), std::abs(y)});
    largest_z = std::max(largest_z, std::abs(z));
  }
  out.largest_xy = largest_xy;
  out.largest_z = largest_z;
}

/// Lays samples out one after the other. A sample without a height (its reach is below 0) gets
/// height 0.
template <HeightType type>
class Layout {
 public:
  Layout(const MeasureUnits& units, GridPoint origin, double origin_code, StarSamples& out)
      : units_(units),
        origin_(origin),
        origin_code_(origin_code),
        out_(out),
        x_(out.x.data()),
        y_(out.y.data()),
        z_(out.z.data()) {
    out.blocks.clear();
    out.directed.clear();
  }
  void add(const Sample& s) {
    add_at(s, s.reach < 0.0F ? 0.0 : code_of<type>(s.height) - origin_code_);
  }
  /// As add(), for samples that have heights.
  void add_surface(const Sample& s) { add_at(s, code_of<type>(s.height) - origin_code_); }
  /// As add(), where surface and void meet.
  void add_with_charge(const Sample& s) {
    const bool directed = s.direction != kNoDirection;
    out_.charge[n_] = directed ? 0.0 : units_.charge(s.reach);
    out_.is_void[n_] = directed || s.reach < 0.0F ? 1.0 : 0.0;
    add(s);
  }
  /// Adds the further corners of blocks, then padding: u itself.
  void finish() {
    const std::size_t total = n_ + 3 * out_.blocks.size();
    const std::size_t padded = (total + kSampleLanes - 1) / kSampleLanes * kSampleLanes;
    out_.x.resize(padded);
    out_.y.resize(padded);
    out_.z.resize(padded);
    x_ = out_.x.data();
    y_ = out_.y.data();
    z_ = out_.z.data();
    if (!out_.surface_only) {
      out_.charge.resize(padded, 0.0);
      out_.is_void.resize(padded, 1.0);
    }
    for (SampleBlock& b : out_.blocks) {
      b.corners = static_cast<std::uint32_t>(n_);
      put(b.x1, b.y0, b.z);
      put(b.x1, b.y1, b.z);
      put(b.x0, b.y1, b.z);
    }
    while (n_ < padded) {
      put(0.0, 0.0, 0.0);
    }
  }
  [[nodiscard]] double largest() const noexcept { return largest_; }

 private:
  void add_at(const Sample& s, double z) {
    x_[n_] = static_cast<double>(s.position.x - origin_.x);
    y_[n_] = static_cast<double>(s.position.y - origin_.y);
    z_[n_] = z;
    largest_ = std::max(largest_, std::abs(z));
    if ((s.side_log | s.direction) != 0) [[unlikely]] {
      add_special(s);
    }
    ++n_;
  }
  void add_special(const Sample& s) {
    if (s.direction != kNoDirection) {
      out_.directed.push_back({static_cast<std::uint32_t>(n_), s.direction, s.reach});
      return;
    }
    const auto reach = static_cast<double>((std::int64_t{1} << s.side_log) - 1);
    out_.blocks.push_back({x_[n_], y_[n_], x_[n_] + reach, y_[n_] + reach, z_[n_], s.reach,
                           static_cast<std::uint32_t>(n_), 0});
  }
  void put(double x, double y, double z) {
    x_[n_] = x;
    y_[n_] = y;
    z_[n_] = z;
    ++n_;
  }
  const MeasureUnits& units_;
  GridPoint origin_;
  double origin_code_;
  StarSamples& out_;
  double *x_, *y_, *z_;
  std::size_t n_ = 0;
  double largest_ = 0.0;
};

/// Calls add(sample) for u, then for the first sample of each list, then for all others. The first
/// of a list is the worst one of its triangle, so the first lanes are a good screen for the choice
/// of w.
template <class Add>
void for_each_sample(const Tile& tile, const StarSamples& s, const Add& add) {
  const Vertex& u = tile.tin.vertices[s.star.center];
  add(Sample{u.position, u.height, tile.vertex_state[s.star.center].reach});
  for (const TriangleId t : s.star.triangles) {
    if (const SampleSlot slot = tile.carried[t].samples; slot.count != 0) {
      add(*tile.samples.data(slot));
    }
  }
  for (const TriangleId t : s.star.triangles) {
    const SampleSlot slot = tile.carried[t].samples;
    const Sample* samples = tile.samples.data(slot);
    for (std::uint32_t i = 1; i < slot.count; ++i) {
      add(samples[i]);
    }
  }
}

template <HeightType type>
void lay_out_samples(const Tile& tile, GridPoint origin, double origin_code, StarSamples& out) {
  std::size_t count = 1;
  for (const TriangleId t : out.star.triangles) {
    count += tile.carried[t].samples.count;
  }
  out.count = count;
  out.x.resize(count);
  out.y.resize(count);
  out.z.resize(count);
  Layout<type> layout(tile.units, origin, origin_code, out);
  if (out.surface_only) {
    for_each_sample(tile, out, [&](const Sample& s) { layout.add_surface(s); });
  } else {
    out.charge.resize(count);
    out.is_void.resize(count);
    for_each_sample(tile, out, [&](const Sample& s) { layout.add_with_charge(s); });
  }
  layout.finish();
  out.largest_z = std::max(out.largest_z, layout.largest());
}

/// Whether all heights in and around the star are that of u: those of the link are (largest_z is
/// 0), and so are those that the triangles of the star cover.
bool is_flat(const Tile& tile, const StarSamples& s) {
  if (!s.surface_only || s.largest_z != 0.0) {
    return false;
  }
  const Interval heights = saturated_heights(tile, s.star);
  return heights.lo == heights.hi;
}

void classify(const Tile& tile, StarSamples& out) {
  out.surface_only = out.surface_triangles = true;
  out.void_only = false;
  if (tile.has_voids) {
    bool void_triangles = false;
    bool surface_triangles = false;
    bool heights = tile.tin.has_height[out.star.center] != 0;
    bool voids = !heights;
    for (const TriangleId t : out.star.triangles) {
      const bool is_void = tile.tin.classes[t] == TriangleClass::kVoid;
      void_triangles |= is_void;
      surface_triangles |= !is_void;
      heights |= tile.carried[t].holds_heights;
      voids |= tile.carried[t].holds_voids;
    }
    out.surface_triangles = !void_triangles;
    out.surface_only = !void_triangles && !voids;
    out.void_only = !surface_triangles && !heights;
  }
}

/// The code that heights are taken relative to: that of u, or of the first link vertex that has a
/// height where u has none; 0 where none has.
double origin_code_of(const Tile& tile, const Star& star) {
  if (tile.tin.has_height[star.center] != 0) {
    return tile.units.heights.code(tile.tin.vertices[star.center].height);
  }
  for (const VertexId v : star.link) {
    if (tile.tin.has_height[v] != 0) {
      return tile.units.heights.code(tile.tin.vertices[v].height);
    }
  }
  return 0.0;
}

}  // namespace

void gather_sources(const Tile& tile, StarSamples& out) {
  out.source.clear();
  out.source.reserve(out.count);
  for_each_sample(tile, out, [&](const Sample& s) { out.source.push_back(s); });
}

void gather_samples(const Tile& tile, StarSamples& out) {
  const GridPoint origin = tile.tin.vertices[out.star.center].position;
  const double origin_code = origin_code_of(tile, out.star);
  if (tile.units.heights.type == HeightType::int32) {
    lay_out_samples<HeightType::int32>(tile, origin, origin_code, out);
  } else {
    lay_out_samples<HeightType::float32>(tile, origin, origin_code, out);
  }
}

namespace {

void gather_shape(const Tile& tile, VertexId u, StarSamples& out) {
  walk_star(tile.tin, u, out.star);
  const GridPoint origin = tile.tin.position(u);
  const double origin_code = origin_code_of(tile, out.star);
  if (tile.units.heights.type == HeightType::int32) {
    gather_link<HeightType::int32>(tile, origin, origin_code, out);
  } else {
    gather_link<HeightType::float32>(tile, origin, origin_code, out);
  }
  classify(tile, out);
  out.count = 0;
  out.blocks.clear();
  out.directed.clear();
}

}  // namespace

void gather_star(const Tile& tile, VertexId u, StarSamples& out) {
  gather_shape(tile, u, out);
  out.flat = is_flat(tile, out);
  if (!out.flat && !out.void_only) {
    gather_samples(tile, out);
  }
}

void gather_star_and_samples(const Tile& tile, VertexId u, StarSamples& out) {
  gather_shape(tile, u, out);
  out.flat = false;
  gather_samples(tile, out);
  gather_sources(tile, out);
}

}  // namespace ptin
