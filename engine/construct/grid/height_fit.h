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
  std::uint64_t count = 0;  ///< Heights seen.
};

/// Sees every height of a source once, then chooses the encoding. The first of these that applies:
///   1. float32, where the source gives float32;
///   2. int32 with step 1, where all heights are whole numbers that fit;
///   3. float32, where it holds every height exactly;
///   4. int32 with a decimal step, down to 0.0001, where all heights are multiples of that step but
///      for the rounding of decimals to binary;
///   5. int32 with a power of two as its step. This moves a height by at most half a step: 2^-31 of
///      the range, or an ulp of the largest height where that is more.
/// A plain value.
class HeightScan {
 public:
  /// The type in which the source holds its heights.
  enum class Given : std::uint8_t { kFloat32, kFloat64 };
  constexpr explicit HeightScan(Given given) noexcept : given_(given) {}

  /// Adds a height. REQUIRES: finite, not beyond the range of a float32. Cost: 10 to 25 ns.
  void add(double height);

  /// Adds the heights that another scan has seen. REQUIRES: both were given the same type.
  void join(const HeightScan& other);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] HeightFit fit() const;

 private:
  static constexpr int kMaxDecimals = 4;  ///< Decimals of the finest step that is tested.
  void test_decimals(double height);
  void choose_rounded(HeightFit& fit) const;
  [[nodiscard]] double float_quantum() const;

  std::uint64_t count_ = 0;
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  Given given_;
  bool all_int32_ = true;
  bool all_float32_ = true;
  bool unused_ = false;  ///< In the place of padding.
  std::int32_t decimals_ =
      0;  ///< Fewest that hold all heights seen; kMaxDecimals + 1: none tested does.
  /// Entry d, for d >= decimals_: the largest distance of a height from a multiple of 10^-d.
  std::array<double, kMaxDecimals + 1> decimal_rounding_{};
};

/// Sets those fields of `frame` that describe the heights.
void set_heights(TerrainFrame& frame, const HeightFit& fit);

/// The stored bits of `height`: the nearest code, ties to even.
/// @throws Error io_error  the code does not fit int32. The encoding was chosen from all heights,
///                         so the source changed between two readings.
[[nodiscard]] HeightBits encode_height(const HeightEncoding& encoding, double height);

/// 10^-decimals, the double nearest to it. REQUIRES: 0 <= decimals <= 22.
[[nodiscard]] double decimal_step(int decimals) noexcept;

}  // namespace ptin
