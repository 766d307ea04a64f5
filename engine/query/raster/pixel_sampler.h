// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a TIN, in any order, made into heights at the centres of pixels.
#pragma once

#include <cstdint>
#include <span>

#include "engine/mesh/tin.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/raster/pixel_centres.h"
#include "engine/query/walk/point_state.h"

namespace ptin {

/// Where a sampler writes: a place for each pixel. What is empty is not told.
template <class Height>
struct PixelBuffers {
  std::span<Height> heights;          ///< Height's unit; NaN without surface.
  std::span<PointState> states{};     ///< What the centre lies on.
  std::span<std::uint32_t> labels{};  ///< A surface triangle that holds the centre; else kNone.
};

/// Samples a TIN at the centres of pixels. What it writes does not depend on the order of the
/// triangles, but for the label of a centre that several surface triangles hold.
/// @tparam Height  float or double.
template <class Height>
class PixelSampler {
 public:
  /// Clears the buffers: nothing lies anywhere yet.
  /// @param facts, centres  Borrowed for the life of the sampler.
  /// REQUIRES: buffers that are not empty have as many places as there are centres.
  PixelSampler(const StoreFacts& facts, const PixelCentres& centres, PixelBuffers<Height> buffers);

  /// Adds a triangle of the TIN. Cost: the pixels below it.
  void add(const LivingTriangle& t, std::uint32_t label = 0);

 private:
  void add_void(const LivingTriangle& t);
  void add_corners(const LivingTriangle& t, std::uint32_t label);
  void set_height(std::size_t place, double height, std::uint32_t label);
  [[nodiscard]] bool is_set(std::size_t place) const noexcept {
    return buffers_.heights[place] == buffers_.heights[place];
  }

  const HeightEncoding encoding_;
  const PixelCentres& centres_;
  PixelBuffers<Height> buffers_;
};

extern template class PixelSampler<float>;
extern template class PixelSampler<double>;

}  // namespace ptin
