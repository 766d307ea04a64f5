// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights as stored: 32 bits and one decoder, the same for vertices and for height intervals.
#pragma once

#include <bit>
#include <cstdint>

namespace ptin {

/// A stored height: the bits of an int32 or of a float32, as HeightEncoding says.
using HeightBits = std::uint32_t;

enum class HeightType : std::uint32_t { int32 = 0, float32 = 1 };

/// The largest code of an int32; the smallest one used is its negative.
inline constexpr double kLargestCode = 2147483647.0;

/// How stored heights become heights. `step` and `offset` are in the height's unit.
///   int32:   height = offset + step * value
///   float32: height = value (step 1, offset 0)
/// The *code* of a height is its stored number as a double, exact for both types; construction and
/// query compare and interpolate codes, and turn them into heights at the border of the library.
struct HeightEncoding {
  HeightType type = HeightType::float32;
  double step = 1.0;
  double offset = 0.0;
  friend bool operator==(const HeightEncoding&, const HeightEncoding&) = default;

  /// The stored number. Exact.
  [[nodiscard]] double code(HeightBits bits) const noexcept {
    return type == HeightType::int32 ? static_cast<double>(std::bit_cast<std::int32_t>(bits))
                                     : static_cast<double>(std::bit_cast<float>(bits));
  }
  /// The bits of a code. REQUIRES: `code` is an int32 or a float32 as the type says.
  [[nodiscard]] HeightBits bits(double code) const noexcept {
    return type == HeightType::int32 ? std::bit_cast<HeightBits>(static_cast<std::int32_t>(code))
                                     : std::bit_cast<HeightBits>(static_cast<float>(code));
  }
  /// The height of a code, in the height's unit. Monotone in the code.
  [[nodiscard]] double height_of_code(double c) const noexcept { return offset + step * c; }
  [[nodiscard]] double height(HeightBits b) const noexcept { return height_of_code(code(b)); }
};

}  // namespace ptin
