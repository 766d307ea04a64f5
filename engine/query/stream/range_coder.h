// SPDX-License-Identifier: GPL-3.0-or-later
//
// An adaptive binary range coder (Martin 1979; carries as in LZMA), and numbers made of its bits.
// storage/FORMAT.md, "Streams", has it step by step: integers alone, the same on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ptin {

/// How likely a bit is 0, in 2^-16: the mean of a fast and a slow estimate.
class BitModel {
 public:
  /// Never 0 and never 65536: the fast estimate stays above 14 and below 65521.
  [[nodiscard]] std::uint32_t zero() const noexcept { return (fast_ + std::uint32_t{slow_}) >> 1; }
  void learn(bool bit) noexcept {
    fast_ = moved(fast_, bit, 4);
    slow_ = moved(slow_, bit, 7);
  }

 private:
  static std::uint16_t moved(std::uint32_t p, bool bit, int rate) noexcept {
    return static_cast<std::uint16_t>(bit ? p - (p >> rate) : p + ((65535 - p) >> rate));
  }
  std::uint16_t fast_ = 32768, slow_ = 32768;
};

/// Writes bits. A bit costs -log2 of the share that its model gave it.
class RangeEncoder {
 public:
  /// @param out  Borrowed; appended to.
  explicit RangeEncoder(std::vector<std::byte>& out) : out_(out) {}

  /// Writes a bit by the model, which learns it. Returns the bit.
  bool code(BitModel& model, bool bit) {
    code_share(model.zero(), bit);
    model.learn(bit);
    return bit;
  }
  /// A bit that is 0 with a share of `zero` / 65536. REQUIRES: 0 < zero < 65536.
  bool code_share(std::uint32_t zero, bool bit) {
    const std::uint32_t bound = (range_ >> 16) * zero;
    if (bit) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    while (range_ < (1U << 24)) {
      range_ <<= 8;
      shift();
    }
    return bit;
  }
  /// Ends the code: writes the bytes that a decoder reads ahead.
  void finish() {
    for (int i = 0; i < 5; ++i) {
      shift();
    }
  }

 private:
  /// Sends the top byte of `low_`; bytes of all ones wait for a carry.
  void shift() {
    if (low_ < 0xFF000000U || low_ > 0xFFFFFFFFU) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32);
      for (std::uint8_t byte = cache_; waiting_ != 0; --waiting_, byte = 0xFF) {
        out_.push_back(static_cast<std::byte>(byte + carry));
      }
      cache_ = static_cast<std::uint8_t>(low_ >> 24);
    }
    ++waiting_;
    low_ = (low_ & 0x00FFFFFFU) << 8;
  }

  std::vector<std::byte>& out_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
  std::uint64_t waiting_ = 1;
  std::uint8_t cache_ = 0;
};

/// Reads the bits again. Behind the end of its input it reads zeros and counts them, so any input
/// is safe.
class RangeDecoder {
 public:
  /// @param in  Borrowed.
  explicit RangeDecoder(std::span<const std::byte> in) : in_(in) {
    for (int i = 0; i < 5; ++i) {
      code_ = (code_ << 8) | next();
    }
  }

  /// Reads a bit by the model, which learns it. The second argument makes the call that of an
  /// encoder.
  bool code(BitModel& model, bool /*unknown*/ = false) {
    const bool bit = code_share(model.zero());
    model.learn(bit);
    return bit;
  }
  bool code_share(std::uint32_t zero, bool /*unknown*/ = false) {
    const std::uint32_t bound = (range_ >> 16) * zero;
    const bool bit = code_ >= bound;
    code_ -= bit ? bound : 0;
    range_ = bit ? range_ - bound : bound;
    while (range_ < (1U << 24)) {
      range_ <<= 8;
      code_ = (code_ << 8) | next();
    }
    return bit;
  }
  /// Bytes taken so far; more than there are when the code is damaged.
  [[nodiscard]] std::size_t taken() const noexcept { return at_; }

 private:
  std::uint32_t next() noexcept {
    const std::size_t i = at_++;
    return i < in_.size() ? static_cast<std::uint32_t>(in_[i]) : 0;
  }

  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
  std::uint32_t code_ = 0;
};

/// A number from 0 to 2^40 - 1 of unknown size: its length in bits, then the bits below the leading
/// one. Length and the first two of these bits are learned.
class NumberModel {
 public:
  /// Codes `v`; a decoder ignores it. Returns the number.
  template <class Coder>
  std::uint64_t code(Coder& coder, std::uint64_t v) {
    std::uint32_t node = 1;
    const auto length = static_cast<std::uint32_t>(std::bit_width(v));
    for (int i = 5; i >= 0; --i) {
      node = 2 * node + (coder.code(length_[node], ((length >> i) & 1U) != 0) ? 1 : 0);
    }
    const std::uint32_t bits = std::min(node - 64, kMostBits);
    if (bits == 0) {
      return 0;
    }
    std::uint64_t result = 1;
    std::size_t path = 1;
    for (std::uint32_t i = bits - 1; i-- > 0;) {
      const bool bit = ((v >> i) & 1U) != 0;
      const bool coded =
          path < 4 ? coder.code(top_[bits][path], bit) : coder.code_share(32768, bit);
      path = 2 * path + (coded ? 1 : 0);
      result = 2 * result + (coded ? 1 : 0);
    }
    return result;
  }

  static constexpr std::uint32_t kMostBits = 40;

 private:
  std::array<BitModel, 64> length_;
  std::array<std::array<BitModel, 4>, kMostBits + 1> top_;
};

/// A number from 0 to a known bound, by halving the range. The first four halvings are learned:
/// apart for each bound below 16, and for larger bounds by their length in bits. Further halvings
/// are uniform.
class RangeModel {
 public:
  /// Codes `v`, 0 <= v <= most; a decoder ignores it. Returns the number. REQUIRES: most < 2^31.
  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t most, std::uint32_t v) {
    const std::uint32_t size =
        most < 16 ? most : 11 + static_cast<std::uint32_t>(std::bit_width(most));
    std::uint32_t low = 0;
    std::uint32_t high = most;
    std::size_t node = 1;
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      bool above = v > middle;
      if (node < 16) {
        above = coder.code(learned_[size][node], above);
        node = 2 * node + (above ? 1 : 0);
      } else {
        const std::uint64_t share =
            (std::uint64_t{middle - low + 1} << 16) / (std::uint64_t{high - low} + 1);
        above = coder.code_share(static_cast<std::uint32_t>(share), above);
      }
      (above ? low : high) = above ? middle + 1 : middle;
    }
    return low;
  }

 private:
  std::array<std::array<BitModel, 16>, 43> learned_;  // most < 2^31: lengths 5 to 31 at 16 to 42
};

}  // namespace ptin
