// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the symbols of a split come from or go to: SplitCode asks for them, one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/stream/split_models.h"

namespace ptin {

/// Symbols out of a code. What is given as their value is not looked at.
class DecodedSymbols {
 public:
  static constexpr bool kAreKnown = false;
  DecodedSymbols(SplitModels& models, RangeDecoder& coder) : models_(models), coder_(coder) {}
  bool bit(std::size_t line, bool bit) { return models_.bit(coder_, line, bit); }
  std::uint32_t range(std::size_t line, std::uint32_t most, std::uint32_t v) {
    return models_.range(coder_, line, most, v);
  }
  std::int64_t height(std::size_t line, std::optional<std::int64_t> expected, std::int64_t number) {
    return models_.height(coder_, line, expected, number);
  }

 private:
  SplitModels& models_;
  RangeDecoder& coder_;
};

/// Symbols that are known, written down as bytes to be coded when their turn comes: only then is
/// known what the models have learned, and which height was the last.
class RecordedSymbols {
 public:
  static constexpr bool kAreKnown = true;
  /// @param out  Borrowed; appended to.
  explicit RecordedSymbols(std::vector<std::byte>& out) : out_(out) {}

  bool bit(std::size_t line, bool bit) {
    put_tag(kBitTag + 2 * line + (bit ? 1 : 0));
    return bit;
  }
  std::uint32_t range(std::size_t line, std::uint32_t most, std::uint32_t v) {
    put_tag(kRangeTag + line);
    put_number(most);
    put_number(v);
    return v;
  }
  /// REQUIRES: both numbers of a height are of 32 bits.
  std::int64_t height(std::size_t line, std::optional<std::int64_t> expected, std::int64_t number) {
    put_tag(kHeightTag + 2 * line + (expected ? 1 : 0));
    put_signed(number);
    if (expected) put_signed(*expected - number);
    return number;
  }

  /// Codes the symbols of one split.
  /// REQUIRES: `symbols` are what one object of this class wrote down.
  static void code(std::span<const std::byte> symbols, SplitModels& models, RangeEncoder& coder);
  /// Most bytes of the symbols of one split: six bits, four ranges, a height.
  static constexpr std::size_t kMostBytes = 6 + 4 * (1 + 5 + 5) + (1 + 5 + 5);

 private:
  static constexpr std::size_t kBitTag = 0;
  static constexpr std::size_t kRangeTag = kBitTag + 2 * std::size_t{kBitLines};
  static constexpr std::size_t kHeightTag = kRangeTag + kRangeLines;
  static_assert(kHeightTag + 2 * kHeightLines <= 256);

  void put_tag(std::size_t tag) { out_.push_back(static_cast<std::byte>(tag)); }
  /// Seven bits a byte, the low ones first; the highest bit says that more follow.
  void put_number(std::uint64_t v) {
    for (; v >= 128; v >>= 7) out_.push_back(static_cast<std::byte>(v | 128));
    out_.push_back(static_cast<std::byte>(v));
  }
  void put_signed(std::int64_t v) {
    put_number((static_cast<std::uint64_t>(v) << 1) ^ static_cast<std::uint64_t>(v >> 63));
  }

  std::vector<std::byte>& out_;
};

}  // namespace ptin
