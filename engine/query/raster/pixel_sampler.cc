// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/pixel_sampler.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/geometry/orient.h"
#include "engine/query/living/spot_in_triangle.h"

namespace ptin {

namespace {

/// Whether a triangle holds no other position of the grid than its corners: when it is half a
/// square unit, by Pick's theorem.
bool is_smallest(const LivingTriangle& t) {
  return orient(t.corner[0].position, t.corner[1].position, t.corner[2].position) == 1;
}

/// Calls found(place, spot, weights) for each centre in the closed triangle.
template <class Found>
void for_centres_in(const PixelCentres& centres, const LivingTriangle& t, const Found& found) {
  const GridBox box = box_of(t);
  if (centres.misses(box)) return;
  const SpotWeights weights_at(t);
  centres.near(t.corner[0].position, t.corner[1].position, t.corner[2].position,
               [&](std::size_t place, Spot q) {
                 const auto weights = weights_at.at(q);
                 if (SpotWeights::is_inside(weights)) found(place, q, weights);
               });
}

}  // namespace

template <class Height>
PixelSampler<Height>::PixelSampler(const StoreFacts& facts, const PixelCentres& centres,
                                   PixelBuffers<Height> buffers)
    : encoding_(facts.heights), centres_(centres), buffers_(buffers) {
  std::fill(buffers.heights.begin(), buffers.heights.end(),
            std::numeric_limits<Height>::quiet_NaN());
  std::fill(buffers.states.begin(), buffers.states.end(), PointState::kOutside);
  std::fill(buffers.labels.begin(), buffers.labels.end(), kNone);
}

template <class Height>
void PixelSampler<Height>::set_height(std::size_t place, double height, std::uint32_t label) {
  buffers_.heights[place] = static_cast<Height>(height);
  if (!buffers_.states.empty()) buffers_.states[place] = PointState::kSurface;
  if (!buffers_.labels.empty()) buffers_.labels[place] = label;
}

template <class Height>
void PixelSampler<Height>::add(const LivingTriangle& t, std::uint32_t label) {
  if (t.is_void) {
    if (!buffers_.states.empty()) add_void(t);
    return;
  }
  if (centres_.are_grid_positions()) {
    add_corners(t, label);
    if (is_smallest(t)) return;
  }
  for_centres_in(centres_, t, [&](std::size_t place, Spot q, const std::array<Int128, 3>& weights) {
    if (is_set(place)) return;  // another triangle gives the same height
    const double code = codes_in(t, encoding_, q, weights).mean();
    set_height(place, encoding_.height_of_code(code), label);
  });
}

template <class Height>
void PixelSampler<Height>::add_void(const LivingTriangle& t) {
  for_centres_in(centres_, t, [&](std::size_t place, Spot, const std::array<Int128, 3>&) {
    if (buffers_.states[place] == PointState::kOutside) buffers_.states[place] = PointState::kVoid;
  });
}

/// Sets the heights of the corners.
template <class Height>
void PixelSampler<Height>::add_corners(const LivingTriangle& t, std::uint32_t label) {
  for (const LivingTriangle::Corner& c : t.corner) {
    const std::size_t place = centres_.place_of(c.position);
    if (place != PixelCentres::kNowhere && !is_set(place)) {
      set_height(place, encoding_.height(c.height), label);
    }
  }
}

template class PixelSampler<float>;
template class PixelSampler<double>;

}  // namespace ptin
