// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the code of splits is made of, symbol by symbol, and the models that learn them.
// storage/FORMAT.md, "Streams", has a line for each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "engine/query/stream/range_coder.h"

namespace ptin {

/// Bits, by the models that they have; of those with more than one the first.
enum BitLine : std::uint8_t {
  kAtBorder,
  kNoLeftTriangle,
  kNoHeight,
  kLeftIsVoid = kNoHeight + 4,
  kRightIsVoid = kLeftIsVoid + 4,
  kBitLines = kRightIsVoid + 4
};
/// Numbers up to a bound.
enum RangeLine : std::uint8_t { kFanFirst, kInnerSize, kBorderSize, kX, kY, kAlong, kRangeLines };
/// Heights, by the length in bits of the range of the fan's heights; the last: there is none.
inline constexpr std::size_t kHeightLines = 34;

/// The models of a stream. Each function codes a symbol by `coder`, and a decoder ignores the value
/// that it is given. They return the symbol. Threads: one owner.
class SplitModels {
 public:
  template <class Coder>
  bool begins_level(Coder& coder, bool begins) {
    return coder.code(level_, begins);
  }
  /// How far the number of w is behind the last one of its level.
  template <class Coder>
  std::uint64_t gap(Coder& coder, std::uint64_t gap) {
    return gap_.code(coder, gap);
  }
  template <class Coder>
  bool bit(Coder& coder, std::size_t line, bool bit) {
    return coder.code(bits_[line], bit);
  }
  template <class Coder>
  std::uint32_t range(Coder& coder, std::size_t line, std::uint32_t most, std::uint32_t v) {
    return ranges_[line].code(coder, most, v);
  }
  /// The number of a height, relative to the one expected, or without that to the last one coded. A
  /// damaged code may give a number beyond 32 bits.
  template <class Coder>
  std::int64_t height(Coder& coder, std::size_t line, std::optional<std::int64_t> expected,
                      std::int64_t number) {
    const std::int64_t from = expected.value_or(last_height_);
    const std::int64_t off = number - from;
    // Small residuals of either sign become small numbers: 0, -1, 1, -2 are 0, 1, 2, 3.
    const std::uint64_t coded = heights_[line].code(
        coder, (static_cast<std::uint64_t>(off) << 1) ^ static_cast<std::uint64_t>(off >> 63));
    last_height_ =
        from + (static_cast<std::int64_t>(coded >> 1) ^ -static_cast<std::int64_t>(coded & 1U));
    return last_height_;
  }

 private:
  BitModel level_;
  NumberModel gap_;
  std::array<BitModel, kBitLines> bits_;
  std::array<RangeModel, kRangeLines> ranges_;
  std::array<NumberModel, kHeightLines> heights_;
  std::int64_t last_height_ = 0;
};

}  // namespace ptin
