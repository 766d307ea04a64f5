// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which 32-bit encoding holds the heights of a source, found in one pass over them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "engine/construct/grid/terrain_frame.h"
#include "engine/geometry/height.h"

namespace ptin {

/// What one pass over the heights found.
struct HeightFit {
  HeightEncoding encoding;
  double quantum = 0.0;  ///< As TerrainFrame::height_quantum.
  double rounding =
      0.0;  ///< Bound of |decoded - given| over all heights, the height's unit; 0: exact.
  double min_height = 0.0;  ///< Decoded. min > max when there is no height.
  double max_height = -1.0;
  std::uint64_t count = 0;
};

/// Sees every height once, then chooses. Float32 heights stay float32. Others become int32 where
/// they are whole numbers that fit, else float32 where it holds every one exactly, else int32 with
/// a decimal step (0.1 .. 0.0001) where they are such decimals written in binary, else int32 with a
/// power of two as its step, which moves a height by at most half a step, 2^-31 of the range (or an
/// ulp of the largest).
class HeightScan {
 public:
  enum class Given : std::uint8_t { kFloat32, kFloat64 };
  explicit HeightScan(Given given) : given_(given) {}

  /// Adds a height. REQUIRES: finite, not beyond the range of a float32. Cost: 10 to 25 ns.
  void add(double height);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] HeightFit fit() const;

 private:
  static constexpr int kMaxDecimals = 4;  ///< That heights are tested for.
  void test_decimals(double height);
  void choose_rounded(HeightFit& fit) const;
  [[nodiscard]] double float_quantum() const;

  Given given_;
  std::uint64_t count_ = 0;
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  bool all_int32_ = true;
  bool all_float32_ = true;
  int decimals_ = 0;  ///< Fewest that all heights seen have; kMaxDecimals + 1: too many.
  /// Largest distance of any height to a multiple of each step from decimals_ on.
  std::array<double, kMaxDecimals + 1> decimal_rounding_{};
};

/// Writes what `fit` says into `frame`.
void set_heights(TerrainFrame& frame, const HeightFit& fit);

/// The stored bits of `height`: the nearest code, ties to even.
/// @throws Error io_error  it does not fit: the source changed between two readings
[[nodiscard]] HeightBits encode_height(const HeightEncoding& encoding, double height);

/// 10^-decimals, the double nearest to it. REQUIRES: 0 <= decimals <= 22.
[[nodiscard]] double decimal_step(int decimals) noexcept;

}  // namespace ptin
