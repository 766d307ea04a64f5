// SPDX-License-Identifier: GPL-3.0-or-later
//
// The receiver's side of the code of splits: which w is next, then the split (split_code.h).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/stream/range_coder.h"
#include "engine/query/stream/split_code.h"
#include "engine/query/stream/split_models.h"

namespace ptin {

/// Decodes splits one after the other, and learns as it goes. Threads: one owner.
class SplitDecoder {
 public:
  explicit SplitDecoder(HeightType type) : code_(type) {}

  /// Begins a block with the next split: numbers the vertices of `tin` along the Hilbert curve.
  /// Cost: linear in the mesh, and n log n in the vertices that are new.
  void begin_block(const Tin& tin);

  /// Decodes the split that comes next on `tin`: any input is safe, as of SplitCode::decode().
  /// @return null; or why there is no split, as a sentence's predicate ("names a w ..."). Then
  /// neither the code nor this object can be used on.
  [[nodiscard]] const char* decode(RangeDecoder& coder, const Tin& tin, LocalSplit& split);

 private:
  [[nodiscard]] VertexId vertex_at(std::uint64_t rank) const noexcept {
    return rank < curve_.size() ? curve_[rank].vertex : static_cast<VertexId>(rank);
  }

  SplitCode code_;
  SplitModels models_;
  std::uint64_t last_w_ = 0;  ///< Number of the last w.
  struct OnCurve {
    std::uint64_t position;
    VertexId vertex;
    friend bool operator<(const OnCurve& a, const OnCurve& b) noexcept {
      return a.position < b.position;
    }
  };
  /// Vertices along the curve, when the block began. A later one keeps its id, behind all of these.
  std::vector<OnCurve> curve_;
};

}  // namespace ptin
