// SPDX-License-Identifier: GPL-3.0-or-later
//
// Into which neighbour a vertex would be collapsed, and with what error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// The choice for one vertex.
struct CollapseChoice {
  static constexpr std::size_t kNoNeighbour = std::numeric_limits<std::size_t>::max();
  std::size_t j = kNoNeighbour;  ///< w is link[j]; kNoNeighbour when no collapse is allowed.
  /// Largest error of a sample in the fan, in height codes, rounded up; may be +infinity.
  double error = 0.0;
};

/// Finds the best w of a star: the one with the least error, then with the smallest key. A w that
/// would have more than kComfortableDegree neighbours (mesh/collapse.h) is taken only when no other
/// is allowed. Keeps scratch buffers between calls; one chooser a thread.
class CollapseChooser {
 public:
  /// Chooses for the centre of `s`. Fills `s.source` where it must decide exactly whether an error
  /// is 0.
  /// @param full  That of measure_with_voids().
  /// @param s     As gather_star() leaves it.
  /// Cost: the square of the degree for screening, which computes the residual of u alone for each
  /// w; then, for most stars, one pass over all samples for the best w, and a few lanes for one or
  /// two others. Candidates are measured in the order of their screens, and given up once they
  /// exceed the best.
  [[nodiscard]] CollapseChoice choose(const Tile& tile, const FullSurface* full, StarSamples& s);

 private:
  struct Candidate {
    double screen;    ///< |residual| of u, a lower bound of the error; 0 where it is not known.
    std::uint32_t j;  ///< w is link[j].
  };
  /// The best so far.
  struct Best {
    std::size_t j = CollapseChoice::kNoNeighbour;
    double error = std::numeric_limits<double>::infinity();  ///< Height codes, not rounded up yet.
    double charge = 0.0;  ///< Largest charge within `error` (VoidMeasure).
    double fixed = 0.0;   ///< What fixed edges count for within `error`.
    VertexKey key = kNoVertexKey;
  };
  void collect(const Tile& tile, const StarSamples& s);
  void screen_all(const StarSamples& s);
  void select_next(const Tile& tile, const StarSamples& s, std::size_t first);
  [[nodiscard]] static bool is_crowded(const Tile& tile, const StarSamples& s, std::size_t j);
  [[nodiscard]] Best best_of(const Tile& tile, const StarSamples& s, bool crowded_too);
  void measure(const Tile& tile, const StarSamples& s, std::size_t j, Best& best);
  /// What fixed edges count for in the error of candidate link[j], rounded up; any number above
  /// `stop_above` where it is more than that.
  [[nodiscard]] double fixed_gap(const Tile& tile, const StarSamples& s, std::size_t j,
                                 double stop_above);
  [[nodiscard]] double certified(const Tile& tile, StarSamples& s, const Best& best);

  std::vector<Candidate> candidates_;
  // Scratch of screening: the link, padded; the cross products of link i and link k, relative to u;
  // and for each w twice the area of its smallest fan triangle, and its screen.
  std::vector<double> x_, y_, z_, crosses_, least_, screens_;
  bool screened_ = false;  ///< Whether the candidates' screens are known.
  FanFrame fan_;
  const FullSurface* full_ = nullptr;
  bool has_fixed_edges_ = false;  ///< Whether `full_` has any.
};

}  // namespace ptin
