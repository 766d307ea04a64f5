// SPDX-License-Identifier: GPL-3.0-or-later
//
// The adaptive arithmetic coder of LAZ, its reading half. A. Said, "Introduction to Arithmetic Coding:
// Theory and Practice", HP Labs report HPL-2004-76, as LASzip uses it (M. Isenburg, "LASzip: lossless
// compression of LiDAR data", PE&RS 79(2), 2013; the constants are of that program's open source).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/construct/laz/byte_window.h"

namespace ptin::laz {

/// How likely each of some symbols is: counts that decay, and every so often the places that they
/// give the symbols in [0, 2^15).
/// @tparam kMost  So many symbols there are at most, 2 .. 516.
template <std::uint32_t kMost>
class SymbolModel {
 public:
  /// Makes all symbols equally likely. REQUIRES: 2 <= symbols <= kMost.
  void begin(std::uint32_t symbols = kMost) noexcept {
    symbols_ = symbols;
    counts_.fill(1);
    total_ = 0;
    cycle_ = symbols;
    update();
    cycle_ = left_ = (symbols + 6) / 2;
  }

 private:
  friend class ArithmeticDecoder;

  static constexpr std::uint32_t kPlaceBits = 15;
  static constexpr std::uint32_t kMostTotal = 1U << 15;

  /// Slots of the table that is looked into before symbols are compared; none for few symbols.
  static constexpr std::uint32_t slot_bits() noexcept {
    std::uint32_t bits = 3;
    while (kMost > 16 && (1U << (bits + 2)) < kMost) {
      ++bits;
    }
    return bits;
  }
  static constexpr std::uint32_t kSlots = 1U << slot_bits();
  static constexpr std::uint32_t kSlotShift = kPlaceBits - slot_bits();

  void update() noexcept {
    total_ += cycle_;
    if (total_ > kMostTotal) {
      total_ = 0;
      for (std::uint32_t i = 0; i < symbols_; ++i) {
        counts_[i] = static_cast<std::uint16_t>((counts_[i] + 1U) / 2);
        total_ += counts_[i];
      }
    }
    place_symbols();
    const std::uint32_t longest = (symbols_ + 6) * 8;
    cycle_ = cycle_ * 5 / 4 < longest ? cycle_ * 5 / 4 : longest;
    left_ = cycle_;
  }

  /// Gives each symbol its place by the counts before it, and each slot the symbol that it begins in.
  void place_symbols() noexcept {
    const std::uint32_t scale = 0x80000000U / total_;
    std::uint32_t sum = 0, slot = 0;
    for (std::uint32_t i = 0; i < symbols_; ++i) {
      places_[i] = static_cast<std::uint16_t>((scale * sum) >> (31 - kPlaceBits));
      sum += counts_[i];
      if constexpr (kMost > 16) {
        for (const std::uint32_t end = places_[i] >> kSlotShift; slot < end;) {
          slots_[++slot] = static_cast<std::uint16_t>(i - 1);
        }
      }
    }
    if constexpr (kMost > 16) {
      while (slot <= kSlots) {
        slots_[++slot] = static_cast<std::uint16_t>(symbols_ - 1);
      }
      slots_[0] = 0;
    }
  }

  /// Counts a symbol that was read.
  void count(std::uint32_t symbol) noexcept {
    ++counts_[symbol];
    if (--left_ == 0) {
      update();
    }
  }

  std::array<std::uint16_t, kMost> places_;  ///< The first place of each symbol, ascending.
  std::array<std::uint16_t, kMost> counts_;
  std::array<std::uint16_t, (kMost > 16 ? kSlots + 2 : 1)> slots_;
  std::uint32_t symbols_ = 0, total_ = 0;
  std::uint32_t cycle_ = 0,
                left_ = 0;  ///< Symbols from one update to the next, and until the next.
};

/// How likely a bit is 0.
class BitModel {
 public:
  void begin() noexcept { *this = {}; }

 private:
  friend class ArithmeticDecoder;

  static constexpr std::uint32_t kPlaceBits = 13;

  void count(bool bit) noexcept {
    zeros_ += bit ? 0 : 1;
    if (--left_ == 0) {
      update();
    }
  }
  void update() noexcept {
    total_ += cycle_;
    if (total_ > 1U << kPlaceBits) {
      total_ = (total_ + 1) / 2;
      zeros_ = (zeros_ + 1) / 2;
      total_ += zeros_ == total_ ? 1 : 0;
    }
    place_ = (zeros_ * (0x80000000U / total_)) >> (31 - kPlaceBits);
    cycle_ = cycle_ * 5 / 4 < 64 ? cycle_ * 5 / 4 : 64;
    left_ = cycle_;
  }

  std::uint32_t place_ = 1U << (kPlaceBits - 1);  ///< Where 1 begins in [0, 2^13].
  std::uint32_t zeros_ = 1, total_ = 2;
  std::uint32_t cycle_ = 4, left_ = 4;
};

/// Reads symbols out of bytes. Invariant, whatever the bytes: the value lies below the length of the
/// interval, so that every symbol that is found is one of its model.
/// Every function throws as ByteWindow::next() where the bytes end.
class ArithmeticDecoder {
 public:
  explicit ArithmeticDecoder(const Source& source) : bytes_(source) {}

  /// Begins with the bytes from `begin` up to `end` of the file.
  void open(std::uint64_t begin, std::uint64_t end);
  /// Bytes that were not read. A writer ends its bytes so that a reader of all symbols has read them
  /// all.
  [[nodiscard]] std::uint64_t left() const noexcept { return bytes_.left(); }

  template <std::uint32_t kMost>
  [[nodiscard]] std::uint32_t symbol(SymbolModel<kMost>& model) {
    const std::uint32_t whole = length_;
    length_ >>= SymbolModel<kMost>::kPlaceBits;
    const std::uint32_t found = find(model, value_ / length_);
    const std::uint32_t low = model.places_[found] * length_;
    const std::uint32_t high =
        found + 1 == model.symbols_ ? whole : model.places_[found + 1] * length_;
    narrow(low, high);
    model.count(found);
    return found;
  }

  [[nodiscard]] bool bit(BitModel& model) {
    const std::uint32_t middle = model.place_ * (length_ >> BitModel::kPlaceBits);
    const bool is_one = value_ >= middle;
    narrow(is_one ? middle : 0, is_one ? length_ : middle);
    model.count(is_one);
    return is_one;
  }

  /// Bits that all are equally likely, 1 .. 32 of them, the lowest first where there are many.
  [[nodiscard]] std::uint32_t bits(std::uint32_t count) {
    if (count > 19) {
      const std::uint32_t low = bits(16);
      return bits(count - 16) << 16 | low;
    }
    length_ >>= count;
    const std::uint32_t found = value_ / length_;
    value_ -= found * length_;
    refill();
    return found;
  }

 private:
  /// The last symbol whose place is not beyond `place`.
  template <std::uint32_t kMost>
  [[nodiscard]] static std::uint32_t find(const SymbolModel<kMost>& model,
                                          std::uint32_t place) noexcept {
    std::uint32_t found = 0, beyond = model.symbols_;
    if constexpr (kMost > 16) {
      const std::uint32_t slot = place >> SymbolModel<kMost>::kSlotShift;
      found = model.slots_[slot];
      beyond = model.slots_[slot + 1] + 1U;
    }
    while (beyond > found + 1) {
      const std::uint32_t middle = (found + beyond) / 2;
      (model.places_[middle] > place ? beyond : found) = middle;
    }
    return found;
  }

  /// The interval becomes [low, high) of itself.
  void narrow(std::uint32_t low, std::uint32_t high) {
    value_ -= low;
    length_ = high - low;
    refill();
  }
  void refill() {
    while (length_ < kLeastLength) {
      value_ = value_ << 8 | bytes_.next();
      length_ <<= 8;
    }
  }

  static constexpr std::uint32_t kLeastLength = 1U << 24;

  ByteWindow bytes_;
  std::uint32_t value_ = 0, length_ = 0xffffffffU;
};

}  // namespace ptin::laz
