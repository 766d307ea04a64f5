// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/star_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace ptin {

namespace {

void gather_link(const Tile& tile, GridPoint origin, double origin_code, StarSamples& out) {
  const std::size_t degree = out.star.degree();
  out.link_x.resize(degree);
  out.link_y.resize(degree);
  out.link_z.resize(degree);
  for (std::size_t i = 0; i < degree; ++i) {
    const Vertex& v = tile.tin.vertices[out.star.link[i]];
    out.link_x[i] = static_cast<double>(v.position.x) - origin.x;
    out.link_y[i] = static_cast<double>(v.position.y) - origin.y;
    out.largest_xy = std::max({out.largest_xy, std::abs(out.link_x[i]), std::abs(out.link_y[i])});
    out.link_z[i] = tile.tin.has_height[out.star.link[i]] != 0 ? tile.units.heights.code(v.height) - origin_code : 0.0;
    out.largest_z = std::max(out.largest_z, std::abs(out.link_z[i]));
  }
}

/// The first sample of each list comes first of all: it is the worst one of its triangle, so the first block of lanes is a
/// good screen for the choice of w.
void gather_sources(const Tile& tile, VertexId u, StarSamples& out) {
  const Vertex& vertex = tile.tin.vertices[u];
  out.source.clear();
  out.source.push_back({vertex.position, vertex.height, tile.vertex_state[u].depth});
  std::size_t total = 1;
  for (const TriangleId t : out.star.triangles) {
    const SampleSlot slot = tile.carried[t].samples;
    if (slot.count != 0) {
      out.source.push_back(*tile.samples.data(slot));
      total += slot.count;
    }
  }
  if (total == out.source.size()) {
    return;
  }
  out.source.reserve(total);
  for (const TriangleId t : out.star.triangles) {
    const SampleSlot slot = tile.carried[t].samples;
    if (slot.count > 1) {
      const Sample* samples = tile.samples.data(slot);
      out.source.insert(out.source.end(), samples + 1, samples + slot.count);
    }
  }
}

template <HeightType type>
double code_of(HeightBits bits) noexcept {
  return type == HeightType::int32 ? static_cast<double>(std::bit_cast<std::int32_t>(bits))
                                   : static_cast<double>(std::bit_cast<float>(bits));
}

template <HeightType type>
void spread(GridPoint origin, double origin_code, StarSamples& out) {
  const std::size_t n = out.source.size();
  const std::size_t padded = (n + kSampleLanes - 1) / kSampleLanes * kSampleLanes;
  out.x.resize(padded);
  out.y.resize(padded);
  out.z.resize(padded);
  double largest = out.largest_z;
  for (std::size_t i = 0; i < n; ++i) {
    const Sample& s = out.source[i];
    out.x[i] = static_cast<double>(s.position.x - origin.x);
    out.y[i] = static_cast<double>(s.position.y - origin.y);
    out.z[i] = s.depth < 0.0F ? 0.0 : code_of<type>(s.height) - origin_code;
    largest = std::max(largest, std::abs(out.z[i]));
  }
  for (std::size_t i = n; i < padded; ++i) {
    out.x[i] = out.y[i] = out.z[i] = 0.0;  // u itself once more
  }
  out.largest_z = largest;
}

void classify(const Tile& tile, StarSamples& out) {
  out.surface_only = true;
  out.void_only = false;
  if (!tile.has_voids) {
    return;
  }
  std::size_t voids = 0;
  for (const TriangleId t : out.star.triangles) {
    voids += tile.tin.classes[t] == TriangleClass::kVoid ? 1 : 0;
  }
  std::size_t without_height = 0;
  for (const Sample& s : out.source) {
    without_height += s.depth < 0.0F ? 1 : 0;
  }
  out.surface_only = voids == 0 && without_height == 0;
  out.void_only = voids == out.star.triangles.size() && without_height == out.source.size();
}

/// Heights are taken relative to u's; where u has none, to that of some link vertex.
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

void gather_star(const Tile& tile, VertexId u, StarSamples& out) {
  walk_star(tile.tin, u, out.star);
  const GridPoint origin = tile.tin.vertices[u].position;
  const double origin_code = origin_code_of(tile, out.star);
  out.largest_xy = 0.0;
  out.largest_z = 0.0;
  gather_link(tile, origin, origin_code, out);
  gather_sources(tile, u, out);
  classify(tile, out);
  if (tile.units.heights.type == HeightType::int32) {
    spread<HeightType::int32>(origin, origin_code, out);
  } else {
    spread<HeightType::float32>(origin, origin_code, out);
  }
}

}  // namespace ptin
