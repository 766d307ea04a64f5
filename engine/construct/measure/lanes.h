// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vectors of kSampleLanes doubles for the measuring loops, in the registers that the processor has.
//
// A loop is a struct with a function `run` that is a template over its vector, WideLanes or
// HalfLanes; in_lanes() runs it with the one that suits the processor. AVX2 has a type of its own
// because gcc 12 takes vectors apart lane by lane where they are compared and are wider than the
// instructions that it may use (engine/DECISIONS.md, section 3.3). It does so where two comparisons
// are joined by `&`, too, so loops compare the smaller of two values.
//
// Every type gives the same bits: operations are those of IEEE 754 on single lanes, none is fused
// (-ffp-contract=off), and where a NaN or a zero's sign may decide, both types decide alike.
//
// The linker cannot take code for one processor in the place of code for another: what may use
// AVX-512 or AVX2 is run_wide() and run_half() alone, each a function of its own name for each loop,
// and what is inlined into them. Functions that are not inlined there, those of the standard
// library too, are compiled as everywhere else.
#pragma once

#include <cstdint>

#include "engine/construct/measure/star_samples.h"

namespace ptin {

// Always inlined, and so compiled with the instructions of its caller: a function that is only
// inline may be called, without them and with its vectors in memory.
#define PTIN_LANES inline __attribute__((always_inline))

/// One register of AVX-512.
using WideLanes = double __attribute__((vector_size(64)));

/// Two registers of AVX2; elsewhere what the compiler makes of it.
struct HalfLanes {
  using Half = double __attribute__((vector_size(32)));

  HalfLanes() = default;
  PTIN_LANES HalfLanes(Half low_lanes, Half high_lanes) noexcept
      : low(low_lanes), high(high_lanes) {}
  // Implicit, as in the arithmetic of vectors and single numbers that WideLanes has. Named four times:
  // to add to a vector of zeros takes an addition, and loses the sign of a zero.
  PTIN_LANES HalfLanes(double all) noexcept  // NOLINT(google-explicit-constructor)
      : low{all, all, all, all}, high(low) {}

  friend PTIN_LANES HalfLanes operator+(HalfLanes a, HalfLanes b) noexcept {
    return {a.low + b.low, a.high + b.high};
  }
  friend PTIN_LANES HalfLanes operator-(HalfLanes a, HalfLanes b) noexcept {
    return {a.low - b.low, a.high - b.high};
  }
  friend PTIN_LANES HalfLanes operator*(HalfLanes a, HalfLanes b) noexcept {
    return {a.low * b.low, a.high * b.high};
  }
  friend PTIN_LANES HalfLanes operator/(HalfLanes a, HalfLanes b) noexcept {
    return {a.low / b.low, a.high / b.high};
  }
  friend PTIN_LANES HalfLanes operator-(HalfLanes a) noexcept { return {-a.low, -a.high}; }

  Half low{}, high{};
};

/// The value in every lane.
template <class Lanes>
PTIN_LANES Lanes all_lanes(double value) noexcept;
template <>
PTIN_LANES HalfLanes all_lanes<HalfLanes>(double value) noexcept {
  return value;
}
template <>
PTIN_LANES WideLanes all_lanes<WideLanes>(double value) noexcept {
  return WideLanes{value, value, value, value, value, value, value, value};
}

/// The lanes at `from`, which need not be aligned. Each register is loaded by itself: a pair of them
/// that is copied as a whole goes by way of the stack.
template <class Lanes>
PTIN_LANES Lanes load_lanes(const double* from) noexcept {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <>
PTIN_LANES HalfLanes load_lanes<HalfLanes>(const double* from) noexcept {
  return {load_lanes<HalfLanes::Half>(from), load_lanes<HalfLanes::Half>(from + 4)};
}

template <class Lanes>
PTIN_LANES void store_lanes(double* to, const Lanes& lanes) noexcept {
  __builtin_memcpy(to, &lanes, sizeof lanes);
}
template <>
PTIN_LANES void store_lanes<HalfLanes>(double* to, const HalfLanes& lanes) noexcept {
  store_lanes(to, lanes.low);
  store_lanes(to + 4, lanes.high);
}

PTIN_LANES WideLanes smaller(WideLanes a, WideLanes b) noexcept { return b < a ? b : a; }
PTIN_LANES WideLanes larger(WideLanes a, WideLanes b) noexcept { return b > a ? b : a; }
/// `a` in lanes of `value` below `limit`, `b` in others.
PTIN_LANES WideLanes where_below(WideLanes value, double limit, WideLanes a, WideLanes b) noexcept {
  return value < limit ? a : b;
}

PTIN_LANES HalfLanes smaller(HalfLanes a, HalfLanes b) noexcept {
  return {b.low < a.low ? b.low : a.low, b.high < a.high ? b.high : a.high};
}
PTIN_LANES HalfLanes larger(HalfLanes a, HalfLanes b) noexcept {
  return {b.low > a.low ? b.low : a.low, b.high > a.high ? b.high : a.high};
}
PTIN_LANES HalfLanes where_below(HalfLanes value, double limit, HalfLanes a, HalfLanes b) noexcept {
  return {value.low < limit ? a.low : b.low, value.high < limit ? a.high : b.high};
}

template <class Lanes>
PTIN_LANES Lanes magnitude(Lanes a) noexcept {
  return where_below(a, 0.0, -a, a);
}

/// Lanes four apart are compared first, then those two apart, then the last two: in the same order
/// with every type, since it decides which of a NaN and a number stays.
PTIN_LANES double largest_lane(HalfLanes v) noexcept {
  const HalfLanes::Half four = v.high > v.low ? v.high : v.low;
  const auto low = __builtin_shufflevector(four, four, 0, 1);
  const auto high = __builtin_shufflevector(four, four, 2, 3);
  const auto two = high > low ? high : low;
  return two[1] > two[0] ? two[1] : two[0];
}
PTIN_LANES double largest_lane(WideLanes v) noexcept {
  v = larger(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  v = larger(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
  return v[1] > v[0] ? v[1] : v[0];
}

/// The processors that loops in lanes are compiled for, each with all that those before it have.
enum class LaneSet : std::uint8_t { kPlain, kAvx2, kAvx512 };
/// The last that this processor is.
[[nodiscard]] LaneSet lanes_of_processor() noexcept;
/// Has in_lanes() use no more than `most`, in all threads. Answers do not depend on it: it is for
/// tests and measurements.
void use_lanes(LaneSet most) noexcept;
/// The set that in_lanes() uses: at first the last that the processor has.
[[nodiscard]] LaneSet lanes_in_use() noexcept;

namespace lanes_internal {

#ifdef __x86_64__
template <class Loop, class... Arguments>
__attribute__((target("avx512f"))) auto run_wide(Arguments... arguments) noexcept {
  return Loop::template run<WideLanes>(arguments...);
}
template <class Loop, class... Arguments>
__attribute__((target("avx2"))) auto run_half(Arguments... arguments) noexcept {
  return Loop::template run<HalfLanes>(arguments...);
}
#endif

}  // namespace lanes_internal

/// Runs `Loop::run<Lanes>(arguments...)`, an always inlined function (PTIN_LANES), with the lanes that
/// suit the processor. Arguments are passed by value: pointers, numbers, references in structs.
template <class Loop, class... Arguments>
auto in_lanes(Arguments... arguments) noexcept {
#ifdef __x86_64__
  const LaneSet set = lanes_in_use();
  if (set == LaneSet::kAvx512) {
    return lanes_internal::run_wide<Loop>(arguments...);
  }
  if (set == LaneSet::kAvx2) {
    return lanes_internal::run_half<Loop>(arguments...);
  }
#endif
  return Loop::template run<HalfLanes>(arguments...);
}

}  // namespace ptin
