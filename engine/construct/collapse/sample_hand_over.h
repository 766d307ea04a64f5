// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hands the samples of a star to the triangles that take the place of others.
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
  /// Empties the lists of the star's triangles and fills those of `receivers`, one for each
  /// triangle of `frame`. Blocks that lie across a spoke are taken apart; long lists become blocks
  /// where that pays.
  /// @param assignment  Of the elements that are no blocks (measure_fan(), assign_samples()).
  /// @param receivers   Ids of the triangles of the frame.
  /// @param drop_center  Leave out the sample at the centre of the star, which is a vertex from now
  /// on.
  void run(Tile& tile, const StarSamples& s, const FanFrame& frame, const FanAssignment& assignment,
           std::span<const TriangleId> receivers, bool drop_center);

 private:
  /// The samples of one triangle; the worst comes first, since the next choice of w screens by it.
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
