// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/fan_measure.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/construct/measure/lanes.h"

namespace ptin {

namespace {

double cross_wide(double ax, double ay, double bx, double by) noexcept {
  return static_cast<double>(cross_exact(ax, ay, bx, by));
}

double cross(double ax, double ay, double bx, double by, bool wide) noexcept {
  return wide ? cross_wide(ax, ay, bx, by) : ax * by - ay * bx;
}

// The loops in lanes are for narrow stars. Wide stars (more than 2^25 grid units across) are rare
// and take the scalar loop, residual_wide().

/// Samples relative to u, coordinate by coordinate.
struct NarrowSamples {
  const double *x, *y, *z;
};

NarrowSamples narrow(const StarSamples& s) noexcept { return {s.x.data(), s.y.data(), s.z.data()}; }

struct LargestResidual {
  template <class Lanes>
  PTIN_LANES static double run(NarrowSamples s, const FanFrame* frame, std::size_t begin,
                               std::size_t end, double stop_above) noexcept {
    const FanFrame& fan = *frame;
    const std::size_t triangles = fan.triangles();
    const double* sx = fan.spoke_x.data();
    const double* sy = fan.spoke_y.data();
    const double* sz = fan.spoke_z.data();
    const double* det = fan.determinant.data();
    const double* inv = fan.inverse.data();
    double worst = 0.0;
    for (std::size_t k = begin; k < end; k += kSampleLanes) {
      const Lanes qx = load_lanes<Lanes>(s.x + k) - fan.w_x;
      const Lanes qy = load_lanes<Lanes>(s.y + k) - fan.w_y;
      const Lanes qz = load_lanes<Lanes>(s.z + k) - fan.w_z;
      Lanes block = {};
      Lanes before = sx[0] * qy - sy[0] * qx;
      for (std::size_t i = 0; i < triangles; ++i) {
        const Lanes after = sx[i + 1] * qy - sy[i + 1] * qx;
        const Lanes r = magnitude((det[i] * qz + (sz[i] * after - sz[i + 1] * before)) * inv[i]);
        const Lanes within = smaller(before, -after);  // not negative inside of the triangle
        block = larger(block, where_below(within, 0.0, block, r));
        before = after;
      }
      worst = std::max(worst, largest_lane(block));
      if (worst > stop_above) {
        break;
      }
    }
    return worst;
  }
};

/// Puts the fan triangle of each sample, and its residual.
struct AssignTriangles {
  template <class Lanes>
  PTIN_LANES static void run(NarrowSamples s, std::size_t end, const FanFrame* frame,
                             double* triangle, double* residual) noexcept {
    const FanFrame& fan = *frame;
    const std::size_t triangles = fan.triangles();
    for (std::size_t k = 0; k < end; k += kSampleLanes) {
      const Lanes qx = load_lanes<Lanes>(s.x + k) - fan.w_x;
      const Lanes qy = load_lanes<Lanes>(s.y + k) - fan.w_y;
      const Lanes qz = load_lanes<Lanes>(s.z + k) - fan.w_z;
      Lanes found = {};
      Lanes worst = {};
      Lanes before = fan.spoke_x[0] * qy - fan.spoke_y[0] * qx;
      for (std::size_t i = 0; i < triangles; ++i) {
        const Lanes after = fan.spoke_x[i + 1] * qy - fan.spoke_y[i + 1] * qx;
        const Lanes r = magnitude(
            (fan.determinant[i] * qz + (fan.spoke_z[i] * after - fan.spoke_z[i + 1] * before)) *
            fan.inverse[i]);
        const Lanes within = smaller(before, -after);
        worst = where_below(within, 0.0, worst, r);
        found = where_below(within, 0.0, found, all_lanes<Lanes>(static_cast<double>(i)));
        before = after;
      }
      store_lanes(triangle + k, found);
      store_lanes(residual + k, worst);
    }
  }
};

/// The scalar loop: returns the residual of sample k, and gives the fan triangle that holds it.
double residual_wide(const StarSamples& s, const FanFrame& fan, std::size_t k,
                     double& found) noexcept {
  const double qx = s.x[k] - fan.w_x;
  const double qy = s.y[k] - fan.w_y;
  const double qz = s.z[k] - fan.w_z;
  double before = cross_wide(fan.spoke_x[0], fan.spoke_y[0], qx, qy);
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const double after = cross_wide(fan.spoke_x[i + 1], fan.spoke_y[i + 1], qx, qy);
    if (before >= 0.0 && after <= 0.0) {
      found = static_cast<double>(i);
      return std::abs(fan.determinant[i] * qz +
                      (fan.spoke_z[i] * after - fan.spoke_z[i + 1] * before)) *
             fan.inverse[i];
    }
    before = after;
  }
  found = 0.0;
  return 0.0;
}

bool along_the_border(const StarSamples& s, std::size_t j) noexcept {
  const std::size_t last = s.link_x.size() - 1;
  return (j == 0 || j == last) && s.star.triangles.size() >= 2 &&
         cross(s.link_x[0], s.link_y[0], s.link_x[last], s.link_y[last], s.is_wide()) == 0.0;
}

/// Codes of a star as integers of one scale, so that 128 bits hold any residual times twice an
/// area.
class IntegerCodes {
 public:
  void look_at(double code) noexcept {
    if (code != 0.0) {
      int exponent = 0;
      auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(code, &exponent), 53));
      const int zeros =
          std::countr_zero(static_cast<std::uint64_t>(mantissa < 0 ? -mantissa : mantissa));
      highest_ = std::max(highest_, exponent);
      lowest_ = std::min(lowest_, exponent - 53 + zeros);
    }
  }
  [[nodiscard]] bool fit() const noexcept { return highest_ - lowest_ <= 60; }
  [[nodiscard]] std::int64_t operator()(double code) const noexcept {
    return static_cast<std::int64_t>(std::ldexp(code, -lowest_));
  }

 private:
  int lowest_ = 0;
  int highest_ = 0;
};

}  // namespace

bool make_fan(const StarSamples& s, std::size_t j, FanFrame& fan) {
  const std::size_t degree = s.link_x.size();
  if (!s.star.closed && !along_the_border(s, j)) {
    return false;
  }
  const bool wide = s.is_wide();
  fan.j = j;
  fan.w_x = s.link_x[j];
  fan.w_y = s.link_y[j];
  fan.w_z = s.link_z[j];
  fan.set_triangles(degree - 2);
  bool valid = true;
  std::size_t k = j;
  for (std::size_t i = 0; i + 1 < degree; ++i) {
    k = k + 1 == degree ? 0 : k + 1;
    fan.spoke_x[i] = s.link_x[k] - fan.w_x;
    fan.spoke_y[i] = s.link_y[k] - fan.w_y;
    fan.spoke_z[i] = s.link_z[k] - fan.w_z;
    if (i > 0) {
      const double det =
          cross(fan.spoke_x[i - 1], fan.spoke_y[i - 1], fan.spoke_x[i], fan.spoke_y[i], wide);
      valid = valid && det > 0.0;
      fan.determinant[i - 1] = det;
      fan.inverse[i - 1] = 1.0 / det;
      fan.star_triangle[i - 1] = static_cast<std::uint32_t>(k == 0 ? degree - 1 : k - 1);
    }
  }
  return valid;
}

void make_spokes_of_star(const StarSamples& s, FanFrame& fan) {
  const std::size_t triangles = s.star.triangles.size();
  const std::size_t degree = s.link_x.size();
  fan.j = 0;
  fan.w_x = fan.w_y = fan.w_z = 0.0;
  fan.set_triangles(triangles);
  for (std::size_t i = 0; i <= triangles; ++i) {
    const std::size_t k = i == degree ? 0 : i;
    fan.spoke_x[i] = s.link_x[k];
    fan.spoke_y[i] = s.link_y[k];
    fan.spoke_z[i] = s.link_z[k];
    if (i > 0) {
      fan.determinant[i - 1] = cross(fan.spoke_x[i - 1], fan.spoke_y[i - 1], fan.spoke_x[i],
                                     fan.spoke_y[i], s.is_wide());
      fan.inverse[i - 1] = 1.0 / fan.determinant[i - 1];
      fan.star_triangle[i - 1] = static_cast<std::uint32_t>(i - 1);
    }
  }
}

double largest_residual(const StarSamples& s, const FanFrame& fan, std::size_t begin,
                        std::size_t end, double stop_above) noexcept {
  if (!s.is_wide()) {
    return in_lanes<LargestResidual>(narrow(s), &fan, begin, end, stop_above);
  }
  double worst = 0.0;
  double found = 0.0;
  for (std::size_t k = begin; k < end && worst <= stop_above; ++k) {
    worst = std::max(worst, residual_wide(s, fan, k, found));
  }
  return worst;
}

void assign_samples(const StarSamples& s, const FanFrame& fan, std::vector<double>& triangle,
                    std::vector<double>& residual) {
  triangle.resize(s.x.size());
  residual.resize(s.x.size());
  if (!s.is_wide()) {
    in_lanes<AssignTriangles>(narrow(s), s.x.size(), &fan, triangle.data(), residual.data());
    return;
  }
  for (std::size_t k = 0; k < s.x.size(); ++k) {
    residual[k] = residual_wide(s, fan, k, triangle[k]);
  }
}

double residual_bound(const StarSamples& s, const MeasureUnits& units) noexcept {
  const double diameter = 4.0 * s.largest_xy;
  if (units.exact_codes && 24.0 * diameter * diameter * std::max(s.largest_z, 1.0) < 0x1p53) {
    return 0.0;
  }
  return 0x1p-47 * s.largest_z;
}

double certified_residual(double residual, const StarSamples& s,
                          const MeasureUnits& units) noexcept {
  const double bound = residual_bound(s, units);
  if (bound == 0.0) {
    const double nearest = std::nearbyint(residual);
    const double largest_area = 8.0 * s.largest_xy * s.largest_xy;
    if (std::abs(residual - nearest) <= 0x1p-50 * residual && largest_area * nearest < 0x1p48) {
      return nearest;
    }
  }
  return scaled_up(residual) + bound;
}

bool all_residuals_zero(const Tile& tile, const StarSamples& s, const FanFrame& fan) {
  __extension__ using Wide = __int128;
  if (!s.blocks.empty()) {
    return false;
  }
  const HeightEncoding& heights = tile.units.heights;
  const auto link_code = [&](std::size_t spoke) {
    return heights.code(
        tile.tin.vertices[s.star.link[(fan.j + 1 + spoke) % s.star.link.size()]].height);
  };
  const double w_code = heights.code(tile.tin.vertices[s.star.link[fan.j]].height);
  IntegerCodes integer;
  integer.look_at(w_code);
  for (std::size_t i = 0; i <= fan.triangles(); ++i) {
    integer.look_at(link_code(i));
  }
  for (const Sample& sample : s.source) {
    integer.look_at(heights.code(sample.height));
  }
  if (!integer.fit()) {
    return false;
  }
  for (std::size_t k = 0; k < s.source.size(); ++k) {
    const double qx = s.x[k] - fan.w_x;
    const double qy = s.y[k] - fan.w_y;
    const std::int64_t qz = integer(heights.code(s.source[k].height)) - integer(w_code);
    for (std::size_t i = 0; i < fan.triangles(); ++i) {
      const std::int64_t before = cross_exact(fan.spoke_x[i], fan.spoke_y[i], qx, qy);
      const std::int64_t after = cross_exact(fan.spoke_x[i + 1], fan.spoke_y[i + 1], qx, qy);
      if (before < 0 || after > 0) {
        continue;
      }
      const std::int64_t det =
          cross_exact(fan.spoke_x[i], fan.spoke_y[i], fan.spoke_x[i + 1], fan.spoke_y[i + 1]);
      if (Wide{det} * qz + Wide{after} * (integer(link_code(i)) - integer(w_code)) !=
          Wide{before} * (integer(link_code(i + 1)) - integer(w_code))) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace ptin
