// SPDX-License-Identifier: GPL-3.0-or-later
//
// Attributes of points of formats 0 to 5 that nobody here asks for. One decoder reads all attributes
// of a point out of the same bytes, so these are decoded for its next point to be right.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/construct/laz/arithmetic_decoder.h"
#include "engine/construct/laz/integer_decoder.h"

namespace ptin::laz {

/// All have begin(), which takes the attribute of a chunk's first point, and pass(), which passes by
/// that of the next one.
/// @throws as ArithmeticDecoder

/// Times: up to four sequences of them, each of steps that are multiples of one step, about.
class GpsTimes {
 public:
  static constexpr std::size_t kBytes = 8;
  void begin(std::span<const unsigned char> first) noexcept;
  void pass(ArithmeticDecoder& decoder);

 private:
  struct Sequence {
    std::uint64_t time = 0;  ///< The bits of its last one.
    std::int32_t step = 0;
    std::uint32_t odd_steps = 0;  ///< That came one after the other.
  };
  void begin_sequence(ArithmeticDecoder& decoder);
  [[nodiscard]] bool pass_after_no_step(ArithmeticDecoder& decoder);
  [[nodiscard]] bool pass_after_step(ArithmeticDecoder& decoder);
  void take_odd(Sequence& s, std::int32_t step) noexcept;

  std::array<Sequence, 4> sequences_;
  std::uint32_t now_ = 0, newest_ = 0;
  SymbolModel<516> multiples_;
  SymbolModel<6> kinds_;
  IntegerDecoder<32, 9> steps_;
};

/// Colours: which of their six bytes changed, and how; green and blue follow red.
class Colours {
 public:
  static constexpr std::size_t kBytes = 6;
  void begin(std::span<const unsigned char> first) noexcept;
  void pass(ArithmeticDecoder& decoder);

 private:
  [[nodiscard]] int changed(ArithmeticDecoder& decoder, std::uint32_t byte, int predicted);

  std::array<int, 6> last_{};  ///< Low and high byte of red, green, blue.
  SymbolModel<128> changes_;
  std::array<SymbolModel<256>, 6> corrections_;
};

/// Where the waveform of a point is.
class WavePackets {
 public:
  static constexpr std::size_t kBytes = 29;
  void begin(std::span<const unsigned char> first) noexcept;
  void pass(ArithmeticDecoder& decoder);

 private:
  std::int32_t offset_step_ = 0, bytes_ = 0, place_ = 0;
  std::array<std::int32_t, 3> direction_{};
  std::uint32_t kind_ = 0;
  SymbolModel<256> descriptors_;
  std::array<SymbolModel<4>, 4> kinds_;
  IntegerDecoder<32, 1> offsets_, sizes_, places_;
  IntegerDecoder<32, 3> directions_;
};

/// Bytes of any meaning: each is the one of the point before, and a symbol.
class ExtraBytes {
 public:
  explicit ExtraBytes(std::size_t bytes) : bytes_(bytes), corrections_(bytes) {}
  /// @param first  Those of the first point.
  void begin(std::span<const unsigned char> first) noexcept;
  void pass(ArithmeticDecoder& decoder);
  /// Those of the point that was passed last.
  [[nodiscard]] std::span<const unsigned char> bytes() const noexcept { return bytes_; }

 private:
  std::vector<unsigned char> bytes_;
  std::vector<SymbolModel<256>> corrections_;
};

}  // namespace ptin::laz
