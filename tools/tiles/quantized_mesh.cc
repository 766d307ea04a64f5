// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/quantized_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/check.h"
#include "tools/tiles/tile_bytes.h"

namespace ptin::tools {

namespace {

/// Heights of one tile on the lattice of its level.
struct TileHeights {
  std::vector<std::uint16_t> shares;  ///< By vertex, of 32767.
  double least = 0.0, most = 0.0;     ///< Heights of the header: both are float32.
};

TileHeights heights_of(const TileMesh& mesh, double step) {
  std::vector<std::int64_t> steps;
  steps.reserve(mesh.vertices.size());
  for (const TileMesh::Vertex& v : mesh.vertices) steps.push_back(std::llround(v.height / step));
  const auto [low, high] = std::minmax_element(steps.begin(), steps.end());
  const std::int64_t lowest = *low;
  PTIN_CHECK(*high - lowest <= kTileSteps);
  int halvings = 0;
  // A float32 has 24 bits.
  const auto fits = [&](int n) {
    return ((*high - lowest) << n) <= kTileSteps &&
           (std::abs(lowest) << n) + kTileSteps <= (std::int64_t{1} << 24);
  };
  PTIN_CHECK(fits(0));
  while (halvings < 24 && fits(halvings + 1)) ++halvings;
  TileHeights heights;
  heights.least = static_cast<double>(lowest) * step;
  heights.most = heights.least + static_cast<double>(kTileSteps) * std::ldexp(step, -halvings);
  heights.shares.reserve(steps.size());
  for (const std::int64_t s : steps)
    heights.shares.push_back(static_cast<std::uint16_t>((s - lowest) << halvings));
  return heights;
}

/// Positions as a decoder gets them.
std::vector<Vec3> positions_of(const TileMesh& mesh, const TileHeights& heights,
                               const QuantizedMeshTarget& target) {
  const TileBox box = TileGrid::box_of(target.tile);
  const double step = (heights.most - heights.least) / static_cast<double>(kTileSteps);
  std::vector<Vec3> positions;
  positions.reserve(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const TilePoint& p = mesh.vertices[i].at;
    positions.push_back(
        ecef_of(target.grid.globe_point(target.tile.level, {box.min_u + p.u, box.min_v + p.v},
                                        heights.least + step * heights.shares[i])));
  }
  return positions;
}

struct Sphere {
  Vec3 centre;
  double radius = 0.0;
};

Sphere sphere_around(const std::vector<Vec3>& positions) {
  Vec3 low = positions.front(), high = positions.front();
  for (const Vec3& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Sphere sphere{0.5 * (low + high), 0.0};
  for (const Vec3& p : positions)
    sphere.radius = std::max(sphere.radius, length(p - sphere.centre));
  sphere.radius = sphere.radius * (1.0 + 1e-12) + 1e-6;  // rounding of positions
  return sphere;
}

void add_header(const TileHeights& heights, const std::vector<Vec3>& positions, TileBytes& out) {
  const Sphere sphere = sphere_around(positions);
  out.add(sphere.centre);
  out.add(static_cast<float>(heights.least));
  out.add(static_cast<float>(heights.most));
  out.add(sphere.centre);
  out.add(sphere.radius);
  out.add(horizon_occlusion_point(sphere.centre, positions));
}

/// Differences to the value before, the sign in the lowest bit.
template <class ValueOf>
void add_zigzag(std::size_t count, const ValueOf& value_of, TileBytes& out) {
  std::int32_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<std::int32_t>(value_of(i));
    const std::int32_t step = value - last;
    out.add(static_cast<std::uint16_t>((static_cast<std::uint32_t>(step) << 1) ^
                                       static_cast<std::uint32_t>(step >> 31)));
    last = value;
  }
}

/// Triangles, coded by how far an index is below the first one that was not used before.
template <class Index>
void add_triangles(const TileMesh& mesh, TileBytes& out) {
  out.add(static_cast<std::uint32_t>(mesh.triangles.size()));
  std::uint32_t next = 0;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      PTIN_CHECK(v <= next);
      out.add(static_cast<Index>(next - v));
      if (v == next) ++next;
    }
  }
}

/// The vertices on one side of the tile, in the order in which they lie along it.
template <class Index>
void add_side(const TileMesh& mesh, std::int64_t TilePoint::*across, std::int64_t at,
              TileBytes& out) {
  std::int64_t TilePoint::*const along = across == &TilePoint::u ? &TilePoint::v : &TilePoint::u;
  std::vector<std::uint32_t> side;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    if (mesh.vertices[i].at.*across == at) side.push_back(i);
  }
  std::stable_sort(side.begin(), side.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mesh.vertices[a].at.*along < mesh.vertices[b].at.*along;
  });
  out.add(static_cast<std::uint32_t>(side.size()));
  for (const std::uint32_t i : side) out.add(static_cast<Index>(i));
}

template <class Index>
void add_indices(const TileMesh& mesh, TileBytes& out) {
  out.align(sizeof(Index));
  add_triangles<Index>(mesh, out);
  add_side<Index>(mesh, &TilePoint::u, 0, out);
  add_side<Index>(mesh, &TilePoint::v, 0, out);
  add_side<Index>(mesh, &TilePoint::u, kTileSteps, out);
  add_side<Index>(mesh, &TilePoint::v, kTileSteps, out);
}

void add_normals(const TileMesh& mesh, TileBytes& out) {
  constexpr std::uint8_t kOctVertexNormals = 1;
  out.add(kOctVertexNormals);
  out.add(static_cast<std::uint32_t>(2 * mesh.vertices.size()));
  for (const TileMesh::Vertex& v : mesh.vertices) out.add(oct_encoded(v.normal));
}

}  // namespace

std::string quantized_mesh(const TileMesh& mesh, const QuantizedMeshTarget& target) {
  PTIN_CHECK(!mesh.triangles.empty());
  const TileHeights heights = heights_of(mesh, target.height_step);
  const std::size_t count = mesh.vertices.size();
  TileBytes out;
  add_header(heights, positions_of(mesh, heights, target), out);
  out.add(static_cast<std::uint32_t>(count));
  add_zigzag(
      count, [&](std::size_t i) { return mesh.vertices[i].at.u; }, out);
  add_zigzag(
      count, [&](std::size_t i) { return mesh.vertices[i].at.v; }, out);
  add_zigzag(
      count, [&](std::size_t i) { return heights.shares[i]; }, out);
  if (count > 65536) {
    add_indices<std::uint32_t>(mesh, out);
  } else {
    add_indices<std::uint16_t>(mesh, out);
  }
  if (target.has_normals) add_normals(mesh, out);
  return out.take();
}

Vec3 horizon_occlusion_point(const Vec3& centre, std::span<const Vec3> positions) {
  // Cozzi and Ring, "3D Engine Design for Virtual Globes", and K. Ring's "Horizon Culling": in
  // units of the axes the Earth is the unit sphere. A position at distance m, at the angle alpha
  // from the direction, is seen over the horizon from where the point at 1 / cos(alpha + beta) of
  // the direction is, beta = acos(1 / m). Positions below the ellipsoid count as on it.
  const auto scaled = [](const Vec3& p) {
    return Vec3{p.x / kSemiMajor, p.y / kSemiMajor, p.z / kSemiMinor};
  };
  constexpr double kFarAway = 1e6;
  const Vec3 to_centre = scaled(centre);
  // A tile around the Earth has its centre near the Earth's: any direction is as good.
  const double distance = length(to_centre);
  const Vec3 direction = distance > 0 ? (1.0 / distance) * to_centre : Vec3{1.0, 0.0, 0.0};
  double most = 1.0;
  for (const Vec3& p : positions) {
    const Vec3 at = scaled(p);
    const double from_middle = length(at);
    const Vec3 towards = (1.0 / from_middle) * at;
    const double m = std::max(1.0, from_middle);
    const double cos_alpha = dot(towards, direction);
    const double sin_alpha = length(cross(towards, direction));
    const double cos_beta = 1.0 / m;
    const double sin_beta = std::sqrt(m * m - 1.0) * cos_beta;
    const double cosine = cos_alpha * cos_beta - sin_alpha * sin_beta;
    most = std::max(most, cosine > 1.0 / kFarAway ? 1.0 / cosine : kFarAway);
  }
  return most * direction;
}

std::array<std::uint8_t, 2> oct_encoded(const Vec3& unit) noexcept {
  const double sum = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
  double x = unit.x / sum;
  double y = unit.y / sum;
  if (unit.z < 0) {
    const double folded = (1.0 - std::abs(y)) * (x < 0 ? -1.0 : 1.0);
    y = (1.0 - std::abs(x)) * (y < 0 ? -1.0 : 1.0);
    x = folded;
  }
  const auto byte = [](double v) {
    return static_cast<std::uint8_t>(std::lround((std::clamp(v, -1.0, 1.0) * 0.5 + 0.5) * 255.0));
  };
  return {byte(x), byte(y)};
}

}  // namespace ptin::tools
