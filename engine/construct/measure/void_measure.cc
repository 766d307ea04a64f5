// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/void_measure.h"

#include <algorithm>
#include <cmath>

#include "engine/check.h"
#include "engine/construct/measure/lanes.h"
#include "engine/construct/measure/sample_blocks.h"
#include "engine/mesh/collapse.h"

namespace ptin {

namespace {

bool is_void(const Tile& tile, const StarSamples& s, std::size_t star_triangle) {
  return tile.tin.classes[s.star.triangles[star_triangle]] == TriangleClass::kVoid;
}

/// Where a sample lies in the fan.
struct SamplePlace {
  std::size_t surface = kNone;  ///< A closed surface triangle that holds it; kNone: none does.
  std::size_t any = kNone;      ///< A triangle that holds it; a void one where one does.
  bool in_void = false;         ///< A closed void triangle holds it.
  double residual = 0.0;        ///< To `surface`; without that, to an edge with heights, or 0.
};

/// The |vertical distance| of a sample to the plane of fan triangle i.
double residual_to(const FanFrame& fan, std::size_t i, double before, double after, double qz) {
  const double numerator =
      fan.determinant[i] * qz + (fan.spoke_z[i] * after - fan.spoke_z[i + 1] * before);
  return std::abs(numerator) * fan.inverse[i];
}

/// True when a sample in the void fan triangle i lies on an edge of it whose ends both have
/// heights: beyond that edge a surface triangle may lie, here or in another refinement, and hold
/// the sample too.
bool on_edge_with_heights(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                          std::size_t i, bool on_first_spoke, bool on_second_spoke, bool on_link) {
  const std::size_t degree = s.star.degree();
  const auto has_height = [&](std::size_t link) {
    return tile.tin.has_height[s.star.link[link % degree]] != 0;
  };
  const bool w = has_height(fan.j);
  const bool first = has_height(fan.j + 1 + i);
  const bool second = has_height(fan.j + 2 + i);
  return (on_first_spoke && w && first) || (on_second_spoke && w && second) ||
         (on_link && first && second);
}

SamplePlace locate(const Tile& tile, const StarSamples& s, const FanFrame& fan, double x, double y,
                   double z) {
  SamplePlace place;
  const double qx = x - fan.w_x;
  const double qy = y - fan.w_y;
  const double qz = z - fan.w_z;
  double on_edge = 0.0;
  std::int64_t before = cross_exact(fan.spoke_x[0], fan.spoke_y[0], qx, qy);
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const std::int64_t after = cross_exact(fan.spoke_x[i + 1], fan.spoke_y[i + 1], qx, qy);
    if (before >= 0 && after <= 0) {
      const auto b = static_cast<double>(before);
      const auto a = static_cast<double>(after);
      const double link_side = fan.determinant[i] - b + a;  // 0 on the link edge
      if (is_void(tile, s, fan.star_triangle[i])) {
        place.any = i;
        place.in_void = true;
        if (on_edge_with_heights(tile, s, fan, i, before == 0, after == 0, link_side == 0.0)) {
          on_edge = std::max(on_edge, residual_to(fan, i, b, a, qz));
        }
      } else {
        place.any = place.any == kNone ? i : place.any;
        place.surface = i;
        place.residual = residual_to(fan, i, b, a, qz);
      }
    }
    before = after;
  }
  if (place.surface == kNone) {
    place.residual = on_edge;
  }
  return place;
}

void charge(VoidMeasure& measure, double amount) {
  measure.charge = std::max(measure.charge, amount);
  measure.error = std::max(measure.error, amount);
}

/// Charges one sample at its place.
void measure_sample(const Tile& tile, const SamplePlace& place, float reach, VoidMeasure& measure) {
  if (reach < 0.0F) {
    if (!place.in_void) {
      charge(measure, tile.units.charge(reach));
    }
  } else if (place.surface != kNone) {
    measure.error = std::max(measure.error, place.residual);
    measure.deviation = std::max(measure.deviation, place.residual);
  } else {
    charge(measure, tile.units.charge(reach));
    measure.error = std::max(measure.error, place.residual);
  }
}

/// What kSampleLanes samples are found to cost.
template <class Lanes>
struct LaneMeasure {
  /// The largest residual of a sample with a height in a surface triangle that holds it; -1 where
  /// none does. 0 for a sample without a height.
  Lanes residual;
  Lanes charge;  ///< Charge of a sample without a height: 0 where a void triangle holds it. Else 0.
};

template <class Lanes>
PTIN_LANES LaneMeasure<Lanes> measure_lanes(const StarSamples& s, const FanFrame& fan,
                                            const unsigned char* is_surface,
                                            std::size_t k) noexcept {
  const Lanes none = all_lanes<Lanes>(-1.0);
  const Lanes zero = {};
  const Lanes qx = load_lanes<Lanes>(s.x.data() + k) - fan.w_x;
  const Lanes qy = load_lanes<Lanes>(s.y.data() + k) - fan.w_y;
  const Lanes qz = load_lanes<Lanes>(s.z.data() + k) - fan.w_z;
  Lanes residual = none;
  Lanes in_void = none;  // below 0 where no void triangle holds it
  Lanes before = fan.spoke_x[0] * qy - fan.spoke_y[0] * qx;
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const Lanes after = fan.spoke_x[i + 1] * qy - fan.spoke_y[i + 1] * qx;
    const Lanes within = smaller(before, -after);
    if (is_surface[i] != 0) {
      const Lanes r = magnitude(
          (fan.determinant[i] * qz + (fan.spoke_z[i] * after - fan.spoke_z[i + 1] * before)) *
          fan.inverse[i]);
      residual = larger(residual, where_below(within, 0.0, none, r));
    } else {
      in_void = larger(in_void, within);
    }
    before = after;
  }
  const Lanes voidness = -load_lanes<Lanes>(s.is_void.data() + k);  // below 0 where it has none
  const Lanes charge = load_lanes<Lanes>(s.charge.data() + k);
  return {where_below(voidness, 0.0, zero, residual),
          where_below(voidness, 0.0, where_below(in_void, 0.0, charge, zero), zero)};
}

/// Measures from sample `begin` on while every sample with a height has a surface triangle and the
/// error does not exceed `stop_above`. Returns the first place whose lanes hold a sample that has
/// lost its surface, or s.x.size() when there is none or the error is exceeded.
struct MeasureWhileFound {
  template <class Lanes>
  PTIN_LANES static std::size_t run(const StarSamples* samples, const FanFrame* fan,
                                    const unsigned char* is_surface, std::size_t begin,
                                    double stop_above, double* residual, double* charge) noexcept {
    const std::size_t end = samples->x.size();
    for (std::size_t k = begin; k < end; k += kSampleLanes) {
      const auto m = measure_lanes<Lanes>(*samples, *fan, is_surface, k);
      if (largest_lane(-m.residual) > 0.0) {
        return k;
      }
      *residual = std::max(*residual, largest_lane(m.residual));
      *charge = std::max(*charge, largest_lane(m.charge));
      if (std::max(*residual, *charge) > stop_above) {
        return end;
      }
    }
    return end;
  }
};

/// Measures a block: each corner as a sample. Where the corners lie in different fan triangles, the
/// block is charged for each of these triangles, and those between, that is of the wrong class.
void measure_block(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                   const SampleBlock& b, VoidMeasure& measure) {
  std::size_t first = fan.triangles();
  std::size_t last = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const SamplePlace place = locate(tile, s, fan, corner == 0 || corner == 3 ? b.x0 : b.x1,
                                     corner < 2 ? b.y0 : b.y1, b.z);
    measure_sample(tile, place, b.reach, measure);
    first = std::min(first, place.any);
    last = std::max(last, place.any);
  }
  for (std::size_t i = first; i <= last && first != last; ++i) {
    const bool is_wrong = is_void(tile, s, fan.star_triangle[i]) == (b.reach >= 0.0F);
    if (is_wrong) {
      charge(measure, tile.units.charge(b.reach));
    }
  }
}

/// Measures samples one by one: those of a wide star, and those in lanes in which one has lost its
/// surface.
void measure_singly(const Tile& tile, const StarSamples& s, const FanFrame& fan, std::size_t begin,
                    std::size_t end, VoidMeasure& measure) {
  for (std::size_t k = begin; k < std::min(end, s.count); ++k) {
    const SamplePlace place = locate(tile, s, fan, s.x[k], s.y[k], s.z[k]);
    if (s.is_void[k] != 0.0) {
      charge(measure, place.in_void ? 0.0 : s.charge[k]);
      continue;
    }
    if (place.surface == kNone) {
      charge(measure, s.charge[k]);
    } else {
      measure.deviation = std::max(measure.deviation, place.residual);
    }
    measure.error = std::max(measure.error, place.residual);
  }
}

void measure_samples(const Tile& tile, const StarSamples& s, FanFrame& fan, double stop_above,
                     VoidMeasure& measure) {
  if (s.is_wide()) {
    measure_singly(tile, s, fan, 0, s.count, measure);
    return;
  }
  fan.is_surface.resize(fan.triangles());
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    fan.is_surface[i] = is_void(tile, s, fan.star_triangle[i]) ? 0 : 1;
  }
  std::size_t k = 0;
  while (k < s.x.size() && measure.error <= stop_above) {
    double residual = 0.0;
    double charged = 0.0;
    k = in_lanes<MeasureWhileFound>(&s, &fan, fan.is_surface.data(), k, stop_above, &residual,
                                    &charged);
    charge(measure, charged);
    measure.error = std::max(measure.error, residual);
    measure.deviation = std::max(measure.deviation, residual);
    if (k < s.x.size()) {
      measure_singly(tile, s, fan, k, k + kSampleLanes, measure);
      k += kSampleLanes;
    }
  }
}

void measure_blocks(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                    VoidMeasure& measure) {
  bool data_blocks = false;
  for (const SampleBlock& b : s.blocks) {
    measure_block(tile, s, fan, b, measure);
    data_blocks |= b.reach >= 0.0F;
  }
  if (data_blocks) {
    const double straddling = straddling_residual(s, fan);
    measure.error = std::max(measure.error, straddling);
    measure.deviation = std::max(measure.deviation, straddling);
  }
}

/// True when link vertex `k` touches a surface triangle of the star, before the collapse.
bool had_surface(const Tile& tile, const StarSamples& s, std::size_t k) {
  const std::size_t triangles = s.star.triangles.size();
  const bool after = k < triangles && !is_void(tile, s, k);
  const bool has_before = k > 0 || s.star.closed;
  return after || (has_before && !is_void(tile, s, k == 0 ? triangles - 1 : k - 1));
}

/// True when link vertex `k` touches a surface triangle of the fan. w touches the whole fan, any
/// other vertex the fan triangles beside its spoke.
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

/// Charges witnesses of triangles that are no longer in a triangle of their class.
void measure_directed(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                      VoidMeasure& measure) {
  for (const DirectedElement& d : s.directed) {
    const std::size_t i = triangle_of_directed(tile, s, fan, d);
    if (is_void(tile, s, fan.star_triangle[i]) != (d.reach < 0.0F)) {
      charge(measure, tile.units.charge(d.reach));
    }
  }
}

/// Charges edges of the fan that come to be on the border between surface and void: spokes between
/// the two, and the link edges at w where the class on their inner side changes (the class beyond may
/// be either, here or in another refinement).
void measure_border(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                    const FullSurface& full, VoidMeasure& measure) {
  const CollapseSite site = collapse_site(s.star, fan.j);
  const std::size_t n = fan.triangles();
  const auto changes = [&](std::size_t spoke) {
    if (spoke > 0 && spoke < n) {
      return is_void(tile, s, fan.star_triangle[spoke - 1]) !=
             is_void(tile, s, fan.star_triangle[spoke]);
    }
    const TriangleId vanishing = spoke == 0 ? site.left : site.right;
    const std::size_t beside = spoke == 0 ? 0 : n - 1;
    return vanishing != kNone && (tile.tin.classes[vanishing] == TriangleClass::kVoid) !=
                                     is_void(tile, s, fan.star_triangle[beside]);
  };
  const GridPoint w = tile.tin.position(s.star.link[fan.j]);
  for (std::size_t spoke = 0; spoke <= n; ++spoke) {
    if (changes(spoke)) {
      const VertexId end = s.star.link[(fan.j + 1 + spoke) % s.star.degree()];
      charge(measure, tile.units.charge(full.border_move(w, tile.tin.position(end))));
    }
  }
}

}  // namespace

VoidMeasure measure_with_voids(const Tile& tile, const StarSamples& s, FanFrame& fan,
                               const FullSurface* full, double stop_above) {
  VoidMeasure measure;
  if (tile.tin.has_height[s.star.link[fan.j]] == 0) {
    for (const std::uint32_t t : fan.star_triangle) {
      if (!is_void(tile, s, t)) {
        return measure;
      }
    }
  }
  measure.allowed = true;
  if (!s.surface_triangles) {  // else the whole fan is surface, and no vertex loses its own
    for (std::size_t k = 0; k < s.star.degree(); ++k) {
      const VertexId v = s.star.link[k];
      if (tile.tin.has_height[v] != 0 && had_surface(tile, s, k) &&
          !keeps_surface(tile, s, fan, k)) {
        charge(measure, tile.units.charge(tile.vertex_state[v].reach));
      }
    }
  }
  measure_directed(tile, s, fan, measure);
  measure_samples(tile, s, fan, stop_above, measure);
  if (measure.error <= stop_above) {
    measure_blocks(tile, s, fan, measure);
  }
  if (measure.error <= stop_above && full != nullptr && !s.surface_triangles) {
    measure_border(tile, s, fan, *full, measure);
  }
  return measure;
}

std::size_t triangle_of_sample(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                               double x, double y, bool has_height) {
  const SamplePlace place = locate(tile, s, fan, x, y, 0.0);
  return has_height && place.surface != kNone ? place.surface : place.any;
}

std::size_t triangle_of_directed(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                                 const DirectedElement& d) {
  const double qx = s.x[d.element] - fan.w_x;
  const double qy = s.y[d.element] - fan.w_y;
  const DirectionStep step = step_of(d.direction);
  const auto side = [&](std::size_t i) {
    const std::int64_t exact = cross_exact(fan.spoke_x[i], fan.spoke_y[i], qx, qy);
    return exact != 0 ? exact : cross_exact(fan.spoke_x[i], fan.spoke_y[i], step.x, step.y);
  };
  std::size_t found = kNone;
  std::int64_t before = side(0);
  for (std::size_t i = 0; i < fan.triangles(); ++i) {
    const std::int64_t after = side(i + 1);
    if (before >= 0 && after <= 0 &&
        (found == kNone || is_void(tile, s, fan.star_triangle[i]) == (d.reach < 0.0F))) {
      found = i;
    }
    before = after;
  }
  PTIN_CHECK(found != kNone);
  return found;
}

}  // namespace ptin
