// SPDX-License-Identifier: GPL-3.0-or-later
//
// The contexts of compressed attributes that follow from numbers of returns, and the differences that
// coordinates are predicted by.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "engine/construct/laz/arithmetic_decoder.h"

namespace ptin::laz {

/// The context of an echo of formats 0 to 5, by how many its pulse has and its number: 0 .. 15.
/// Pulses of 1 to 5 echoes number their echoes through; what no scanner writes has contexts, too.
inline constexpr std::uint8_t kReturnMap[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
    {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
    {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};

/// The same for formats 6 to 10: 0 .. 5.
inline constexpr std::uint8_t kReturnMapOf16[16][16] = {
    {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5},
    {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
    {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3},
    {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5},
};

/// How far the number of an echo is from that of its pulse's echoes, at most 7.
[[nodiscard]] constexpr std::uint32_t return_level(std::uint32_t returns,
                                                   std::uint32_t number) noexcept {
  return std::min<std::uint32_t>(returns < number ? number - returns : returns - number, 7);
}

/// The context of y by the interval that x's correction lay in, and of z by those of both.
[[nodiscard]] constexpr std::uint32_t interval_context(std::uint32_t interval, std::uint32_t most,
                                                       bool is_single) noexcept {
  return (std::min(interval, most) & ~1U) | (is_single ? 1 : 0);
}

/// About the median of recent differences: five values, of which a new one replaces the largest or
/// the smallest, in turn while it goes to the side of the median that shrinks.
class StreamingMedian {
 public:
  [[nodiscard]] std::int32_t value() const noexcept { return sorted_[2]; }
  void add(std::int32_t value) noexcept {
    const bool stays = drops_largest_ ? value < sorted_[2] : value > sorted_[2];
    const std::int32_t* const kept = sorted_.data() + (drops_largest_ ? 0 : 1);
    const std::int32_t a = kept[0], b = kept[1], c = kept[2], d = kept[3];
    sorted_ = {std::min(a, value), std::max(a, std::min(b, value)), std::max(b, std::min(c, value)),
               std::max(c, std::min(d, value)), std::max(d, value)};
    drops_largest_ = drops_largest_ == stays;
  }

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool drops_largest_ = true;
};

/// Models for each of some contexts, of which most are never met with: a model is made when its
/// context comes first.
template <std::uint32_t kSymbols, std::uint32_t kContexts>
class RareModels {
 public:
  void begin() noexcept {
    for (auto& model : models_) {
      if (model) {
        model->begin();
      }
    }
  }
  [[nodiscard]] SymbolModel<kSymbols>& of(std::uint32_t context) {
    auto& model = models_[context];
    if (!model) {
      model = std::make_unique<SymbolModel<kSymbols>>();
      model->begin();
    }
    return *model;
  }

 private:
  std::array<std::unique_ptr<SymbolModel<kSymbols>>, kContexts> models_;
};

}  // namespace ptin::laz
