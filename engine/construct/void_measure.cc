// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/void_measure.h"

#include <algorithm>
#include <cmath>

namespace ptin {

namespace {

bool is_void(const Tile& tile, const StarSamples& s, std::size_t star_triangle) {
  return tile.tin.classes[s.star.triangles[star_triangle]] == TriangleClass::kVoid;
}

std::int64_t cross(double ax, double ay, double bx, double by) noexcept {
  return static_cast<std::int64_t>(ax) * static_cast<std::int64_t>(by) -
         static_cast<std::int64_t>(ay) * static_cast<std::int64_t>(bx);
}

/// Where a sample lies in the fan.
struct Place {
  std::size_t surface = kNone;   ///< A surface triangle that holds it (closed), if any.
  std::size_t any = 0;           ///< Some triangle that holds it.
  bool in_open_surface = false;  ///< Inside of a surface triangle, on no edge.
  double residual = 0.0;         ///< To `surface`.
};

Place locate(const Tile& tile, const StarSamples& s, const FanFrame& fan, std::size_t k) {
  Place place;
  const double qx = s.x[k] - fan.w_x;
  const double qy = s.y[k] - fan.w_y;
  std::int64_t before = cross(fan.spoke_x[0], fan.spoke_y[0], qx, qy);
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const std::int64_t after = cross(fan.spoke_x[i + 1], fan.spoke_y[i + 1], qx, qy);
    if (before >= 0 && after <= 0) {
      place.any = i;
      if (!is_void(tile, s, fan.star_triangle[i])) {
        place.surface = i;
        const double link_side = fan.determinant[i] - static_cast<double>(before) +
                                 static_cast<double>(after);  // 0 on the link edge
        place.in_open_surface = before > 0 && after < 0 && link_side > 0.0;
        const double numerator = fan.determinant[i] * (s.z[k] - fan.w_z) +
                                 (fan.spoke_z[i] * static_cast<double>(after) -
                                  fan.spoke_z[i + 1] * static_cast<double>(before));
        place.residual = std::abs(numerator) * fan.inverse[i];
      }
    }
    before = after;
  }
  return place;
}

double charge(const Tile& tile, float depth) noexcept {
  return static_cast<double>(std::abs(depth)) * tile.units.void_slope_code;
}

/// True when link vertex `k` touches a surface triangle of the star, before the collapse.
bool had_surface(const Tile& tile, const StarSamples& s, std::size_t k) {
  const std::size_t triangles = s.star.triangles.size();
  const bool after = k < triangles && !is_void(tile, s, k);
  const bool has_before = k > 0 || s.star.closed;
  return after || (has_before && !is_void(tile, s, k == 0 ? triangles - 1 : k - 1));
}

/// The same after it: w touches the whole fan, any other the fan triangles beside its spoke.
bool keeps_surface(const Tile& tile, const StarSamples& s, const FanFrame& fan, std::size_t k) {
  const std::size_t degree = s.star.degree();
  const auto surface = [&](std::size_t i) {
    return i < fan.triangles() && !is_void(tile, s, fan.star_triangle[i]);
  };
  if (k == fan.j) {
    for (std::size_t i = 0; i < fan.triangles(); ++i) {
      if (surface(i)) {
        return true;
      }
    }
    return false;
  }
  const std::size_t spoke = (k + degree - fan.j - 1) % degree;
  return surface(spoke) || (spoke > 0 && surface(spoke - 1));
}

}  // namespace

VoidMeasure measure_with_voids(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                               std::vector<double>* triangle) {
  VoidMeasure measure;
  if (triangle != nullptr) {
    triangle->assign(s.x.size(), 0.0);
  }
  if (tile.tin.has_height[s.star.link[fan.j]] == 0) {
    for (const std::uint32_t t : fan.star_triangle) {
      if (!is_void(tile, s, t)) {
        return measure;
      }
    }
  }
  measure.allowed = true;
  for (std::size_t k = 0; k < s.source.size(); ++k) {
    const Sample& sample = s.source[k];
    const Place place = locate(tile, s, fan, k);
    if (triangle != nullptr) {
      (*triangle)[k] = static_cast<double>(
          place.surface != kNone && sample.depth >= 0.0F ? place.surface : place.any);
    }
    if (sample.depth < 0.0F) {
      if (place.in_open_surface) {
        measure.error = std::max(measure.error, charge(tile, sample.depth));
      }
    } else if (place.surface != kNone) {
      measure.error = std::max(measure.error, place.residual);
      measure.deviation = std::max(measure.deviation, place.residual);
    } else {
      measure.error = std::max(measure.error, charge(tile, sample.depth));
    }
  }
  for (std::size_t k = 0; k < s.star.degree(); ++k) {
    const VertexId v = s.star.link[k];
    if (tile.tin.has_height[v] != 0 && had_surface(tile, s, k) && !keeps_surface(tile, s, fan, k)) {
      measure.error = std::max(measure.error, charge(tile, tile.vertex_state[v].depth));
    }
  }
  return measure;
}

}  // namespace ptin
