// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface, asked along the edges of fans: the deviation of a piecewise planar surface from
// another is largest at a vertex of their overlay (engine/DESIGN.md, section 5.3).
#pragma once

#include <cstdint>
#include <span>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"

namespace ptin {

/// One end of an edge that is asked about: a vertex of the full TIN.
struct EdgeEnd {
  GridPoint position;
  double code;  ///< Its height code.
};

/// The full surface of a tile. Threads: const, callable from several at once.
class FullSurface {
 public:
  FullSurface() = default;
  FullSurface(const FullSurface&) = delete;
  FullSurface& operator=(const FullSurface&) = delete;
  virtual ~FullSurface() = default;

  /// A bound on the vertical distance between the straight edge a-b and the full surface along it,
  /// taken at its crossings with edges of the full TIN that have surface beside them; height codes.
  /// Tight up to rounding; 0 where all heights are equal. Cost: the number of crossings.
  [[nodiscard]] virtual double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const = 0;
};

/// Collects gaps at crossings and bounds their rounding: all terms are differences from one
/// reference height, of at most Z; a crossing takes fewer than 16 roundings of 2^-53 relative to 2
/// Z.
class GapMaximum {
 public:
  explicit GapMaximum(double reference) noexcept : reference_(reference) {}
  /// A crossing: full surface between codes p and q at fraction f, edge height `e` relative to the
  /// reference.
  void add(double p, double q, double f, double e) noexcept {
    const double low = p - reference_;
    const double rise = q - p;
    const double gap = low + rise * f - e;
    gap_ = gap > gap_ ? gap : (-gap > gap_ ? -gap : gap_);
    const double size = (low < 0 ? -low : low) + (rise < 0 ? -rise : rise) + (e < 0 ? -e : e);
    size_ = size > size_ ? size : size_;
  }
  [[nodiscard]] double bound() const noexcept { return gap_ + 0x1p-47 * size_; }

 private:
  double reference_;
  double gap_ = 0.0;
  double size_ = 0.0;
};

}  // namespace ptin
