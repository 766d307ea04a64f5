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
  double error =
      0.0;  ///< Largest error of a sample in the fan, height codes, rounded up; may be +infinity.
};

/// Finds the best w of a star: least error, then smallest key; one of more than kComfortableDegree
/// neighbours only when there is no other. Scratch buffers are kept between calls; one chooser a
/// thread.
class CollapseChooser {
 public:
  /// Cost: the square of the degree for the screen (the residual of u alone), which orders the
  /// candidates and leaves the worse ones unmeasured; then for most stars one pass over the samples
  /// for the winner, and a few lanes for one or two others, which are given up once they exceed the
  /// best.
  [[nodiscard]] CollapseChoice choose(const Tile& tile, StarSamples& s);

 private:
  struct Candidate {
    std::size_t j;
    double screen;  ///< |residual| of u, a lower bound of the error; 0 where it is not known.
    VertexKey key;
  };
  void collect(const Tile& tile, const StarSamples& s);
  void screen_all(const Tile& tile, const StarSamples& s);
  void set_crowded_aside(const Tile& tile, const StarSamples& s);
  [[nodiscard]] CollapseChoice choose_among_candidates(const Tile& tile, StarSamples& s);
  void select_next(std::size_t first);
  [[nodiscard]] CollapseChoice choose_on_surface(const Tile& tile, StarSamples& s);
  [[nodiscard]] CollapseChoice choose_with_voids(const Tile& tile, const StarSamples& s);

  std::vector<Candidate> candidates_;
  std::vector<Candidate> crowded_;  ///< Taken only when no other is allowed.
  std::vector<double>
      crosses_;  ///< crosses_[i * degree + k]: cross product of link i and link k, relative to u.
  bool screened_ = false;  ///< Whether the candidates' screens are known.
  FanFrame fan_;
};

}  // namespace ptin
