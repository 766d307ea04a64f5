// SPDX-License-Identifier: GPL-3.0-or-later
//
// For a vertex that would go: into which neighbour, and with what error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/tile.h"

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
    double screen;    ///< |residual| of u, a lower bound of the error; 0 where it is not known.
    std::uint32_t j;  ///< w is link[j].
  };
  /// The best so far.
  struct Best {
    std::size_t j = CollapseChoice::kNoNeighbour;
    double error = std::numeric_limits<double>::infinity();  ///< Not raised by its rounding yet.
    double charge = 0.0;
    VertexKey key = kNoVertexKey;
  };
  void collect(const Tile& tile, const StarSamples& s);
  void screen_all(const StarSamples& s);
  void select_next(const Tile& tile, const StarSamples& s, std::size_t first);
  [[nodiscard]] static bool is_crowded(const Tile& tile, const StarSamples& s, std::size_t j);
  [[nodiscard]] Best best_of(const Tile& tile, const StarSamples& s, bool crowded_too);
  void measure(const Tile& tile, const StarSamples& s, std::size_t j, Best& best);
  [[nodiscard]] double certified(const Tile& tile, StarSamples& s, const Best& best);

  std::vector<Candidate> candidates_;
  // Scratch of the screen: the link, padded; cross products of link i and link k, relative to u;
  // and of each w its smallest fan triangle and its screen.
  std::vector<double> x_, y_, z_, crosses_, least_, screens_;
  bool screened_ = false;  ///< Whether the candidates' screens are known.
  FanFrame fan_;
};

}  // namespace ptin
