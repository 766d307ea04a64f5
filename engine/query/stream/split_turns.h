// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of the splits of a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/point.h"

namespace ptin {

/// A split of a frame, by what orders it.
struct SplitTurn {
  static constexpr std::uint64_t kMadeHere = std::uint64_t{1} << 63;
  /// A number of w, below kMadeHere, where it was there when the frame began. Else kMadeHere and
  /// `at` of the split that makes it; once in order, kMadeHere and the place of that split.
  std::uint64_t w;
  VertexKey u;
  std::uint32_t level;  ///< The longest chain of splits of the frame that it depends on.
  std::uint32_t at;     ///< Which split it is, below their number.
};

/// Puts splits in the order in which they are sent: by level, by the number of w (a vertex that the
/// frame makes comes behind all others, in this very order), and by u. The order is the same for a
/// part of a frame that holds what its splits depend on: so whoever knows a part alone puts that in
/// the order that it has in the whole. Cost: O(n log n).
/// @return False where a split does not come after the one that makes its w; nothing is in order then.
[[nodiscard]] bool put_in_order(std::vector<SplitTurn>& turns);

}  // namespace ptin
