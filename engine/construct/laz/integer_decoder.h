// SPDX-License-Identifier: GPL-3.0-or-later
//
// Integers of LAZ: each is predicted, and what corrects the prediction is coded.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "engine/construct/laz/arithmetic_decoder.h"

namespace ptin::laz {

/// Integers of `kBits` bits, predicted in one of `kContexts` contexts. A symbol says in which
/// interval of the lengths 2, 2, 4, 8, ... around the prediction the integer lies; its place there
/// follows: a bit, a symbol, or for long intervals a symbol of 8 bits and the rest as it is.
/// Corrections wrap around, as they do for writers.
template <std::uint32_t kBits, std::uint32_t kContexts>
class IntegerDecoder {
 public:
  void begin() noexcept {
    for (auto& model : intervals_) {
      model.begin();
    }
    bit_.begin();
    for (std::uint32_t k = 1; k <= kPlaced; ++k) {
      places_[k - 1].begin(1U << (k < kSymbolBits ? k : kSymbolBits));
    }
    interval_ = 0;
  }

  /// @throws as ArithmeticDecoder
  [[nodiscard]] std::int32_t read(ArithmeticDecoder& decoder, std::int32_t predicted,
                                  std::uint32_t context = 0) {
    interval_ = decoder.symbol(intervals_[context]);
    const std::uint32_t sum = static_cast<std::uint32_t>(predicted) + correction(decoder);
    return static_cast<std::int32_t>(kBits < 32 ? sum & ((std::uint64_t{1} << kBits) - 1) : sum);
  }
  /// The number of the interval that was last read, 0 .. kBits.
  [[nodiscard]] std::uint32_t interval() const noexcept { return interval_; }

 private:
  static constexpr std::uint32_t kSymbolBits = 8;
  static constexpr std::uint32_t kPlaced = kBits < 32 ? kBits : 31;  ///< Intervals with places.

  [[nodiscard]] std::uint32_t correction(ArithmeticDecoder& decoder) {
    if (interval_ == 0) {
      return decoder.bit(bit_) ? 1 : 0;
    }
    if (interval_ > kPlaced) {
      return 0x80000000U;
    }
    std::uint32_t place = decoder.symbol(places_[interval_ - 1]);
    if (interval_ > kSymbolBits) {
      const std::uint32_t rest = interval_ - kSymbolBits;
      place = place << rest | decoder.bits(rest);
    }
    // The upper half are the corrections from 2^(k-1) + 1 on, the lower half those up to -2^(k-1).
    return place >= 1U << (interval_ - 1) ? place + 1 : place - ((1U << interval_) - 1);
  }

  std::array<SymbolModel<kBits + 1>, kContexts> intervals_;
  BitModel bit_;
  std::array<SymbolModel<256>, kPlaced> places_;
  std::uint32_t interval_ = 0;
};

}  // namespace ptin::laz
