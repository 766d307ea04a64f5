// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hands the samples of the triangles around a vertex to the triangles that take their place.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "engine/construct/measure/fan_error.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// Moves samples between triangles: from a star to its fan when a vertex goes, from the fan to the
/// star when it comes back. One a thread; keeps scratch buffers.
class SampleHandOver {
 public:
  /// Empties the lists of the star's triangles, and fills the lists of `receivers`. A block that
  /// lies across a spoke is taken apart; a long list is joined into blocks where that pays.
  /// @param s            With `source` (gather_sources()).
  /// @param frame        The triangles that the samples go to: the fan, or the star itself.
  /// @param assignment   Where each element that is no block goes (measure_fan(),
  ///     assign_samples()).
  /// @param receivers    For each triangle of `frame`: its id in the tile.
  /// @param drop_center  Leave out the sample at the centre of the star: it is a vertex again.
  /// @throws Error resource_exhausted  as SampleLists::take
  void run(Tile& tile, const StarSamples& s, const FanFrame& frame, const FanAssignment& assignment,
           std::span<const TriangleId> receivers, bool drop_center);

 private:
  /// The samples of one triangle. The one with the largest residual comes first, since the next
  /// choice of w measures it early.
  struct List {
    std::vector<Sample> samples;
    double worst = 0.0;
    void add(const Sample& sample, double residual) {
      samples.push_back(sample);
      if (samples.size() == 1) {
        worst = residual;
      } else if (residual > worst) {
        worst = residual;
        std::swap(samples.front(), samples.back());
      }
    }
  };
  void add_block(const Tile& tile, const StarSamples& s, const FanFrame& frame,
                 const Sample& block);
  void store(Tile& tile, const FanFrame& frame, std::size_t i, CarriedState& carried);

  bool drop_center_ = false;
  std::vector<List> lists_;  ///< One for each receiver.
};

}  // namespace ptin
