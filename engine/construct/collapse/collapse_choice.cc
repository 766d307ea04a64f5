// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/collapse_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/check.h"
#include "engine/construct/measure/fan_deviation.h"
#include "engine/construct/measure/lanes.h"
#include "engine/construct/measure/sample_blocks.h"
#include "engine/construct/measure/void_measure.h"
#include "engine/geometry/infinity.h"
#include "engine/mesh/collapse.h"
#include "storage/layout.h"

namespace ptin {

namespace {

/// What screening reads: the link of a closed star, relative to u, padded with zeros to `stride`, a
/// multiple of kSampleLanes. And what it writes: the cross product of link i and link w at
/// [i * stride + w], and two results for each w.
struct Screening {
  const double *x, *y, *z;
  std::size_t degree, stride;
  double *crosses, *least, *screens;
};

template <class Lanes>
PTIN_LANES void fill_crosses(const Screening& in) noexcept {
  for (std::size_t i = 0; i < in.degree; ++i) {
    for (std::size_t w = 0; w < in.stride; w += kSampleLanes) {
      store_lanes(in.crosses + i * in.stride + w,
                  in.x[i] * load_lanes<Lanes>(in.y + w) - in.y[i] * load_lanes<Lanes>(in.x + w));
    }
  }
}

/// Screens every w by the residual of u, from the cross products of the link alone. With c(i, k)
/// the cross product of link vertices i and k relative to u, the fan triangle (w, i, i + 1) has
/// twice the area c(i, i + 1) + c(w, i) - c(w, i + 1), and u lies in it where
/// c(w, i) >= 0 >= c(w, i + 1). (At the two edges of w there is no fan triangle, and none seems to
/// hold u, since c(i, i + 1) > 0 in a closed star.) For each w, `least` gets twice the area of its
/// smallest fan triangle, and `screens` gets |residual| of u.
struct Screen {
  template <class Lanes>
  PTIN_LANES static void run(Screening in) noexcept {
    constexpr double kNumbers[kSampleLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
    fill_crosses<Lanes>(in);
    Lanes number = load_lanes<Lanes>(kNumbers);
    for (std::size_t w = 0; w < in.stride; w += kSampleLanes) {
      const Lanes w_z = load_lanes<Lanes>(in.z + w);
      Lanes least = all_lanes<Lanes>(kInfinity);
      Lanes numerator = {};
      Lanes area = all_lanes<Lanes>(1.0);
      std::size_t i = in.degree - 1;
      for (std::size_t k = 0; k < in.degree; i = k++) {
        const Lanes c_i = load_lanes<Lanes>(in.crosses + i * in.stride + w);  // -c(w, i)
        const Lanes c_k = load_lanes<Lanes>(in.crosses + k * in.stride + w);
        const Lanes determinant = in.crosses[i * in.stride + k] - c_i + c_k;
        // The smaller is 0 at the two edges of w itself, whose determinant is 0; 1 or more elsewhere.
        const Lanes to_i = magnitude(number - static_cast<double>(i));
        const Lanes to_k = magnitude(number - static_cast<double>(k));
        least = smaller(least, where_below(smaller(to_i, to_k), 0.5, least, determinant));
        const Lanes within = smaller(-c_i, c_k);
        const Lanes n = determinant * -w_z + ((in.z[k] - w_z) * c_i - (in.z[i] - w_z) * c_k);
        numerator = where_below(within, 0.0, numerator, n);
        area = where_below(within, 0.0, area, determinant);
      }
      store_lanes(in.least + w, least);
      store_lanes(in.screens + w, magnitude(numerator) * (1.0 / area));
      number = number + static_cast<double>(kSampleLanes);
    }
  }
};

void copy_padded(const std::vector<double>& from, std::size_t stride, std::vector<double>& to) {
  to.resize(std::max(to.size(), stride));
  std::copy(from.begin(), from.end(), to.begin());
  std::fill(to.begin() + static_cast<std::ptrdiff_t>(from.size()),
            to.begin() + static_cast<std::ptrdiff_t>(stride), 0.0);
}

}  // namespace

void CollapseChooser::screen_all(const StarSamples& s) {
  const std::size_t degree = s.star.degree();
  const std::size_t stride = (degree + kSampleLanes - 1) / kSampleLanes * kSampleLanes;
  copy_padded(s.link_x, stride, x_);
  copy_padded(s.link_y, stride, y_);
  copy_padded(s.link_z, stride, z_);
  crosses_.resize(std::max(crosses_.size(), degree * stride));
  least_.resize(std::max(least_.size(), stride));
  screens_.resize(std::max(screens_.size(), stride));
  in_lanes<Screen>(Screening{x_.data(), y_.data(), z_.data(), degree, stride, crosses_.data(),
                             least_.data(), screens_.data()});
  candidates_.resize(degree);
  std::size_t count = 0;
  for (std::size_t w = 0; w < degree; ++w) {
    candidates_[count] = {screened_ ? screens_[w] : 0.0, static_cast<std::uint32_t>(w)};
    count += least_[w] > 0.0 ? 1 : 0;
  }
  candidates_.resize(count);
}

/// Whether w = link[j] would have more than kComfortableDegree neighbours. It takes over the link
/// but for itself and its two neighbours there (one at a border), and loses u.
bool CollapseChooser::is_crowded(const Tile& tile, const StarSamples& s, std::size_t j) {
  return tile.vertex_state[s.star.link[j]].degree + s.star.degree() >
         kComfortableDegree + (s.star.closed ? 4 : 3);
}

/// Makes candidates of the w that leave a valid mesh. Their screens are known where u has a height
/// and all triangles of the star are surface: there u is one of the samples that are measured.
void CollapseChooser::collect(const Tile& tile, const StarSamples& s) {
  const std::size_t degree = s.star.degree();
  candidates_.clear();
  screened_ = false;
  if (degree > layout::kMostDegree) {
    return;  // A page holds no larger star; this one waits until its link has fewer vertices.
  }
  if (s.star.closed && !s.is_wide()) {
    screened_ = s.surface_only || (s.surface_triangles && tile.tin.has_height[s.star.center] != 0);
    screen_all(s);
    return;
  }
  const std::size_t step = s.star.closed ? 1 : degree - 1;  // at a border only the two ends
  for (std::size_t j = 0; j < degree; j += step) {
    if (make_fan(s, j, fan_)) {
      candidates_.push_back({0.0, static_cast<std::uint32_t>(j)});
    }
  }
}

/// Moves the candidate with the least (screen, key) of those from place `first` on to place
/// `first`.
void CollapseChooser::select_next(const Tile& tile, const StarSamples& s, std::size_t first) {
  std::size_t least = first;
  bool ties = false;
  for (std::size_t i = first + 1; i < candidates_.size(); ++i) {
    const double difference = candidates_[i].screen - candidates_[least].screen;
    ties = difference < 0.0 ? false : ties || difference == 0.0;
    least = difference < 0.0 ? i : least;
  }
  if (ties) {
    const auto key = [&](std::size_t i) {
      return key_of(tile.tin.position(s.star.link[candidates_[i].j]));
    };
    const double screen = candidates_[least].screen;
    for (std::size_t i = first; i < candidates_.size(); ++i) {
      if (candidates_[i].screen == screen && key(i) < key(least)) {
        least = i;
      }
    }
  }
  std::swap(candidates_[first], candidates_[least]);
}

double CollapseChooser::fixed_gap(const Tile& tile, const StarSamples& s, std::size_t j,
                                  double stop_above) {
  if (!has_fixed_edges_ || s.void_only) {
    return 0.0;
  }
  PTIN_CHECK(make_fan(s, j, fan_));
  return fan_fixed_gap(tile, s, fan_, {*full_, kEverywhere, stop_above});
}

/// Measures candidate link[j] and makes it the best if it is.
void CollapseChooser::measure(const Tile& tile, const StarSamples& s, std::size_t j, Best& best) {
  double error = 0.0;
  double charge = 0.0;
  if (!s.flat && !s.void_only) {
    PTIN_CHECK(make_fan(s, j, fan_));
    if (s.surface_only) {
      error = largest_residual(s, fan_, 0, s.x.size(), best.error);
      if (!s.blocks.empty() && error <= best.error) {
        error = std::max(error, straddling_residual(s, fan_));
      }
    } else {
      const VoidMeasure measured = measure_with_voids(tile, s, fan_, full_, best.error);
      if (!measured.allowed) {
        return;
      }
      error = measured.error;
      charge = measured.charge;
    }
  }
  if (error > best.error) {
    return;
  }
  const double fixed = fixed_gap(tile, s, j, best.error);
  error = std::max(error, fixed);
  if (error > best.error) {
    return;
  }
  const VertexKey key = key_of(tile.tin.position(s.star.link[j]));
  if (best.j == CollapseChoice::kNoNeighbour || error < best.error || key < best.key) {
    best = {j, error, charge, fixed, key};
  }
}

CollapseChooser::Best CollapseChooser::best_of(const Tile& tile, const StarSamples& s,
                                               bool crowded_too) {
  Best best;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    select_next(tile, s, i);
    const Candidate c = candidates_[i];
    if (c.screen > best.error) {
      break;
    }
    if (!crowded_too && is_crowded(tile, s, c.j)) {
      continue;
    }
    // Where u is the only sample, the screen is the error, and the first candidate is the best.
    if (s.count == 1 && screened_ && !has_fixed_edges_) {
      best = {c.j, c.screen, 0.0, 0.0, kNoVertexKey};
      break;
    }
    measure(tile, s, c.j, best);
  }
  return best;
}

/// The error of the best w as a bound: rounded up, and 0 where exact arithmetic shows that it is 0.
double CollapseChooser::certified(const Tile& tile, StarSamples& s, const Best& best) {
  if (s.flat || s.void_only) {
    return best.fixed;
  }
  const double bound = residual_bound(s, tile.units);
  if (bound > 0.0 && best.charge == 0.0 && best.error <= bound) {
    gather_sources(tile, s);
    if (make_fan(s, best.j, fan_) && all_residuals_zero(tile, s, fan_)) {
      return best.fixed;
    }
  }
  return std::max(certified_residual(best.error, s, tile.units), best.fixed);
}

CollapseChoice CollapseChooser::choose(const Tile& tile, const FullSurface* full, StarSamples& s) {
  full_ = full;
  has_fixed_edges_ = full != nullptr && full->has_fixed_edges();
  collect(tile, s);
  Best best = best_of(tile, s, false);
  if (best.j == CollapseChoice::kNoNeighbour) {
    best = best_of(tile, s, true);
  }
  if (best.j == CollapseChoice::kNoNeighbour) {
    return {};
  }
  return {best.j, certified(tile, s, best)};
}

}  // namespace ptin
