// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse_choice.h"

#include <algorithm>

#include "engine/construct/void_measure.h"
#include "engine/mesh/collapse.h"

namespace ptin {

void CollapseChooser::collect(const Tile& tile, const StarSamples& s) {
  const std::size_t degree = s.star.degree();
  if (frames_.size() < degree) {
    frames_.resize(degree);
  }
  candidates_.clear();
  std::size_t used = 0;
  const std::size_t step = s.star.closed ? 1 : degree - 1;  // at a border only the two ends
  for (std::size_t j = 0; j < degree; j += step) {
    if (make_fan(s, j, frames_[used])) {
      const VertexId w = s.star.link[j];
      candidates_.push_back({used, 0.0, key_of(tile.tin.position(w)),
                             tile.vertex_state[w].degree + degree > kComfortableDegree + 4});
      ++used;
    }
  }
  const auto comfortable = [](const Candidate& c) { return !c.crowded; };
  if (std::any_of(candidates_.begin(), candidates_.end(), comfortable)) {
    std::erase_if(candidates_, [](const Candidate& c) { return c.crowded; });
  }
}

CollapseChoice CollapseChooser::choose_on_surface(const Tile& tile, const StarSamples& s) {
  for (Candidate& c : candidates_) {
    c.screen = largest_residual(s, frames_[c.frame], 0, kSampleLanes, std::numeric_limits<double>::infinity());
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.screen != b.screen ? a.screen < b.screen : a.key < b.key;
  });
  const Candidate* best = nullptr;
  double best_error = std::numeric_limits<double>::infinity();
  for (const Candidate& c : candidates_) {
    if (c.screen > best_error) {
      break;
    }
    double error = c.screen;
    if (s.x.size() > kSampleLanes) {
      error = std::max(error, largest_residual(s, frames_[c.frame], kSampleLanes, s.x.size(), best_error));
    }
    if (error < best_error || (error == best_error && (best == nullptr || c.key < best->key))) {
      best = &c;
      best_error = error;
    }
  }
  const double bound = residual_bound(s, tile.units);
  double error = scaled_up(best_error) + bound;
  if (bound > 0.0 && best_error <= bound && all_residuals_zero(tile, s, frames_[best->frame])) {
    error = 0.0;
  }
  return {frames_[best->frame].j, error};
}

CollapseChoice CollapseChooser::choose_with_voids(const Tile& tile, const StarSamples& s) {
  CollapseChoice best;
  VertexKey best_key = kNoVertexKey;
  const double bound = residual_bound(s, tile.units);
  for (const Candidate& c : candidates_) {
    double error = 0.0;
    if (!s.void_only) {
      const VoidMeasure measure = measure_with_voids(tile, s, frames_[c.frame], nullptr);
      if (!measure.allowed) {
        continue;
      }
      error = scaled_up(measure.error) + bound;
    }
    if (best.j == CollapseChoice::kNoNeighbour || error < best.error || (error == best.error && c.key < best_key)) {
      best = {frames_[c.frame].j, error};
      best_key = c.key;
    }
  }
  return best;
}

CollapseChoice CollapseChooser::choose(const Tile& tile, const StarSamples& s) {
  collect(tile, s);
  if (candidates_.empty()) {
    return {};
  }
  return s.surface_only ? choose_on_surface(tile, s) : choose_with_voids(tile, s);
}

}  // namespace ptin
