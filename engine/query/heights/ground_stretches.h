// SPDX-License-Identifier: GPL-3.0-or-later
//
// What triangles hold of straight segments: the surface along lines, gathered in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/living/living_visitor.h"
#include "engine/query/walk/spot_path.h"

namespace ptin {

/// What one closed triangle holds of a segment: a stretch, or a single point.
struct GroundStretch {
  std::uint32_t segment = 0;
  bool is_surface = false;
  bool is_point = false;
  bool is_vertex = false;                 ///< A point, and a corner of the triangle.
  double from = 0.0, to = 0.0;            ///< Shares of the way along the segment.
  double from_code = 0.0, to_code = 0.0;  ///< Ground at both ends; set on surface.
};

/// Gathers the stretches of the segments of a path. Threads: one owner.
class GroundStretches final : public LivingVisitor {
 public:
  /// @param path        Borrowed.
  /// @param most_bytes  More than this ends the reading.
  GroundStretches(const SpotPath& path, const HeightEncoding& heights, std::uint64_t most_bytes)
      : path_(path), heights_(heights), most_bytes_(most_bytes) {}

  bool begin(std::size_t most_triangles) override;
  void take(const LivingTriangle& t) override;

  /// To be called when all triangles are taken. Cost: O(n log n).
  void sort();
  /// The stretches of a segment, along it; of those that begin and end together a surface one first,
  /// then that of the lowest ground. REQUIRES: sort() was called.
  [[nodiscard]] std::span<const GroundStretch> of(std::size_t segment) const noexcept;
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return stretches_.capacity() * sizeof(GroundStretch);
  }

 private:
  const SpotPath& path_;
  HeightEncoding heights_;
  std::uint64_t most_bytes_;
  std::vector<GroundStretch> stretches_;
};

}  // namespace ptin
