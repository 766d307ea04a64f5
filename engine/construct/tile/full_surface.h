// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface, asked along the edges of fans: there the deviation of a fan is measured
// (engine/DESIGN.md, section 5.3).
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
  /// in height codes. It is taken where the edge crosses edges of the full TIN that have a surface
  /// triangle on one side at least. Tight up to rounding; 0 where all heights are equal. Cost: the
  /// number of crossings.
  [[nodiscard]] virtual double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const = 0;

  /// The same at crossings with edges of breaklines and of the boundary alone, with surface on one
  /// side at least: these count for the error.
  /// @param stop_above  Where the gap is larger, any number above this may be returned.
  [[nodiscard]] virtual double fixed_gap(const EdgeEnd& /*a*/, const EdgeEnd& /*b*/,
                                         double /*stop_above*/) const {
    return 0.0;
  }
  /// False where fixed_gap() is 0 everywhere.
  [[nodiscard]] virtual bool has_fixed_edges() const noexcept { return false; }

  /// How far the border between surface and void moves, in ground units, where the edge a-b comes to
  /// be a part of it: the most in any triangle of the full TIN that the edge crosses, and the reach of
  /// any witness that it passes through (tile/border_witnesses.h). An upper bound; 0 along edges of
  /// the border. Cost: the number of crossings.
  [[nodiscard]] virtual double border_move(GridPoint a, GridPoint b) const = 0;
};

/// The largest gap over the crossings of one edge, in height codes, with a bound of its rounding.
/// All terms are differences from one reference code, of at most Z; a crossing takes fewer than 16
/// roundings of 2^-53 relative to 2 Z.
class GapMaximum {
 public:
  explicit GapMaximum(double reference) noexcept : reference_(reference) {}
  /// Adds a crossing.
  /// @param p, q  Codes at the ends of the edge of the full TIN.
  /// @param f     The fraction from p to q at which it is crossed.
  /// @param e     Code of the edge a-b there, relative to the reference.
  void add(double p, double q, double f, double e) noexcept {
    const double low = p - reference_;
    const double rise = q - p;
    const double gap = low + rise * f - e;
    gap_ = gap > gap_ ? gap : (-gap > gap_ ? -gap : gap_);
    const double size = (low < 0 ? -low : low) + (rise < 0 ? -rise : rise) + (e < 0 ? -e : e);
    size_ = size > size_ ? size : size_;
  }
  /// The largest gap, raised by its rounding.
  [[nodiscard]] double bound() const noexcept { return gap_ + 0x1p-47 * size_; }

 private:
  double reference_;
  double gap_ = 0.0;
  double size_ = 0.0;
};

}  // namespace ptin
