// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight against every triangle of the full TIN, in rationals; and small nasty terrains,
// built for real, since certificates must be true.
#pragma once

#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "engine/query/questions.h"
#include "engine/query/sight/sight.h"
#include "tests/query/line_oracle.h"

namespace ptin::reference {

/// A terrain that went through the builder, and its full TIN.
struct SmallTerrain {
  std::string path;
  std::unique_ptr<Terrain> terrain;
  Tin full;

  /// A raster of whole heights: plateaus, steps, spikes, noise; or points. Sometimes with voids.
  explicit SmallTerrain(std::uint64_t seed, double max_error = 0.0);
  ~SmallTerrain();
  SmallTerrain(const SmallTerrain&) = delete;
  SmallTerrain& operator=(const SmallTerrain&) = delete;
};

struct TrueSight {
  bool defined = false;
  PointState state_p = PointState::kOutside, state_q = PointState::kOutside;
  bool hidden = false;
  double first = 0.0;  ///< Share of the way where the line first goes below; when hidden.
  std::optional<Rational> clearance;
  double void_share = 0.0;
};
/// @param bend  Curvature::drop_at(length), as the engine rounds it.
[[nodiscard]] TrueSight true_sight(const SmallTerrain& t, Spot p, double height_p, Spot q,
                                   double height_q, bool absolute, double bend);

/// The least clearance of the line over the surface near a share of the way, within 2^-30 of it, for
/// the rounding of shares; none where there is no surface. REQUIRES: true_sight().defined.
[[nodiscard]] std::optional<Rational> least_clearance_near(const SmallTerrain& t, Spot p,
                                                           double height_p, Spot q, double height_q,
                                                           bool absolute, double bend,
                                                           double share);

/// The ends of a line that runs along edges, through vertices, along rows, columns and diagonals, or
/// touches a corner of the domain; its ends often lie on edges and vertices, or outside.
[[nodiscard]] std::pair<Spot, Spot> nasty_line(std::mt19937_64& random, const Tin& tin);

}  // namespace ptin::reference
