// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/check.h"
#include "engine/construct/sample_blocks.h"
#include "engine/construct/void_measure.h"
#include "engine/mesh/collapse.h"

namespace ptin {

/// Screens every w by the residual of u, from the cross products of the link alone. With c(i, k)
/// the cross product of link vertices i and k relative to u, the fan triangle (w, i, i + 1) has
/// twice the area c(i, i + 1) + c(w, i) - c(w, i + 1), and u lies in it where c(w, i) >= 0 >= c(w,
/// i + 1).
void CollapseChooser::screen_all(const Tile& tile, const StarSamples& s) {
  const std::size_t degree = s.star.degree();
  crosses_.resize(degree * degree);
  double* c = crosses_.data();
  for (std::size_t i = 0; i < degree; ++i) {
    c[i * degree + i] = 0.0;
    for (std::size_t k = i + 1; k < degree; ++k) {
      const double cross = s.link_x[i] * s.link_y[k] - s.link_y[i] * s.link_x[k];
      c[i * degree + k] = cross;
      c[k * degree + i] = -cross;
    }
  }
  for (std::size_t w = 0; w < degree; ++w) {
    const double* of_w = c + w * degree;
    double screen = 0.0;
    bool valid = true;
    std::size_t i = w + 1 == degree ? 0 : w + 1;
    for (std::size_t n = 2; n < degree; ++n) {
      const std::size_t k = i + 1 == degree ? 0 : i + 1;
      const double determinant = c[i * degree + k] + of_w[i] - of_w[k];
      if (!(determinant > 0.0)) {
        valid = false;
        break;
      }
      if (of_w[i] >= 0.0 && of_w[k] <= 0.0) {
        const double w_z = s.link_z[w];
        const double numerator =
            determinant * -w_z + ((s.link_z[i] - w_z) * of_w[k] - (s.link_z[k] - w_z) * of_w[i]);
        screen = std::abs(numerator) * (1.0 / determinant);
      }
      i = k;
    }
    if (valid) {
      candidates_.push_back({w, screen, key_of(tile.tin.position(s.star.link[w]))});
    }
  }
}

void CollapseChooser::set_crowded_aside(const Tile& tile, const StarSamples& s) {
  crowded_.clear();
  std::erase_if(candidates_, [&](const Candidate& c) {
    const bool is =
        tile.vertex_state[s.star.link[c.j]].degree + s.star.degree() > kComfortableDegree + 4;
    if (is) {
      crowded_.push_back(c);
    }
    return is;
  });
}

void CollapseChooser::collect(const Tile& tile, const StarSamples& s) {
  const std::size_t degree = s.star.degree();
  candidates_.clear();
  screened_ = s.star.closed && !s.is_wide();
  if (screened_) {
    screen_all(tile, s);
  } else {
    const std::size_t step = s.star.closed ? 1 : degree - 1;  // at a border only the two ends
    for (std::size_t j = 0; j < degree; j += step) {
      if (make_fan(s, j, fan_)) {
        candidates_.push_back({j, 0.0, key_of(tile.tin.position(s.star.link[j]))});
      }
    }
  }
  set_crowded_aside(tile, s);
}

/// Moves the candidate with the least (screen, key) of those from `first` on to place `first`.
void CollapseChooser::select_next(std::size_t first) {
  std::size_t least = first;
  for (std::size_t i = first + 1; i < candidates_.size(); ++i) {
    const Candidate& a = candidates_[i];
    const Candidate& b = candidates_[least];
    if (a.screen < b.screen || (a.screen == b.screen && a.key < b.key)) {
      least = i;
    }
  }
  std::swap(candidates_[first], candidates_[least]);
}

CollapseChoice CollapseChooser::choose_on_surface(const Tile& tile, StarSamples& s) {
  Candidate best{CollapseChoice::kNoNeighbour, 0.0, kNoVertexKey};
  double best_error = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    select_next(i);
    const Candidate& c = candidates_[i];
    if (c.screen > best_error) {
      break;
    }
    if (s.count == 1 &&
        screened_) {  // u is the only sample: the screen is the error, and the first the best
      best = c;
      best_error = c.screen;
      break;
    }
    if (s.flat) {
      if (best_error != 0.0 || c.key < best.key) {
        best = c;
        best_error = 0.0;
      }
      continue;
    }
    PTIN_CHECK(make_fan(s, c.j, fan_));
    double error = largest_residual(s, fan_, 0, s.x.size(), best_error);
    if (!s.blocks.empty() && error <= best_error) {
      error = std::max(error, straddling_residual(s, fan_));
    }
    if (error < best_error || (error == best_error && c.key < best.key)) {
      best = c;
      best_error = error;
    }
  }
  const double bound = residual_bound(s, tile.units);
  double error = certified_residual(best_error, s, tile.units);
  if (bound > 0.0 && best_error <= bound) {
    gather_sources(tile, s);
    if (make_fan(s, best.j, fan_) && all_residuals_zero(tile, s, fan_)) {
      error = 0.0;
    }
  }
  return {best.j, error};
}

CollapseChoice CollapseChooser::choose_with_voids(const Tile& tile, const StarSamples& s) {
  CollapseChoice best;
  VertexKey best_key = kNoVertexKey;
  for (const Candidate& c : candidates_) {
    double error = 0.0;
    if (!s.void_only) {
      PTIN_CHECK(make_fan(s, c.j, fan_));
      const VoidMeasure measure = measure_with_voids(tile, s, fan_);
      if (!measure.allowed) {
        continue;
      }
      error = certified_residual(measure.error, s, tile.units);
    }
    if (best.j == CollapseChoice::kNoNeighbour || error < best.error ||
        (error == best.error && c.key < best_key)) {
      best = {c.j, error};
      best_key = c.key;
    }
  }
  return best;
}

CollapseChoice CollapseChooser::choose(const Tile& tile, StarSamples& s) {
  collect(tile, s);
  CollapseChoice choice = choose_among_candidates(tile, s);
  if (choice.j == CollapseChoice::kNoNeighbour) {
    candidates_.swap(crowded_);
    choice = choose_among_candidates(tile, s);
  }
  return choice;
}

CollapseChoice CollapseChooser::choose_among_candidates(const Tile& tile, StarSamples& s) {
  if (candidates_.empty()) {
    return {};
  }
  return s.surface_only ? choose_on_surface(tile, s) : choose_with_voids(tile, s);
}

}  // namespace ptin
