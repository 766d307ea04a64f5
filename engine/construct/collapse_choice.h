// SPDX-License-Identifier: GPL-3.0-or-later
//
// For a vertex that would go: into which neighbour, and with what error.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "engine/construct/fan_measure.h"
#include "engine/construct/star_samples.h"
#include "engine/construct/tile.h"

namespace ptin {

/// The choice for one vertex.
struct CollapseChoice {
  static constexpr std::size_t kNoNeighbour = std::numeric_limits<std::size_t>::max();
  std::size_t j = kNoNeighbour;  ///< w is link[j]; kNoNeighbour when no collapse is allowed.
  double error = 0.0;            ///< Largest error of a sample in the fan, height codes, rounded up; may be +infinity.
};

/// Finds the best w of a star: least error, then smallest key; one of more than kComfortableDegree neighbours only when
/// there is no other. Scratch buffers are kept between calls; one chooser a thread.
class CollapseChooser {
 public:
  /// Cost: for most stars one full pass over the samples (for the winner) and one block of lanes for each other candidate, since
  /// candidates are tried in the order of a screen and given up once they exceed the best.
  [[nodiscard]] CollapseChoice choose(const Tile& tile, const StarSamples& s);

 private:
  struct Candidate {
    std::size_t frame;  ///< Index into frames_.
    double screen;      ///< Its largest residual in the first block of lanes.
    VertexKey key;
    bool crowded;
  };
  [[nodiscard]] CollapseChoice choose_on_surface(const Tile& tile, const StarSamples& s);
  [[nodiscard]] CollapseChoice choose_with_voids(const Tile& tile, const StarSamples& s);
  void collect(const Tile& tile, const StarSamples& s);

  std::vector<FanFrame> frames_;
  std::vector<Candidate> candidates_;
};

}  // namespace ptin
