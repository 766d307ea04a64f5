// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vectors of kSampleLanes doubles for the measuring loops, as wide as the processor has them.
//
// A loop is a template over its vector, WideLanes or HalfLanes, and in_lanes() runs it with the one
// that suits the processor. gcc 12 takes vectors apart lane by lane where they are wider than the
// instructions that it may use and are compared, which is why AVX2 has a type of its own; and where
// two comparisons are joined by `&`, so loops compare the smaller of two values.
//
// All operations are those of IEEE 754 on single lanes, none is fused: each type gives the same bits.
#pragma once

#include <cstdint>
#include <utility>

#include "engine/construct/measure/star_samples.h"

namespace ptin {

// Always inlined, and so compiled for the processor of its caller.
#define PTIN_LANES inline __attribute__((always_inline))

/// One vector of AVX-512.
using WideLanes = double __attribute__((vector_size(64)));

/// Two vectors of AVX2.
struct HalfLanes {
  using Half = double __attribute__((vector_size(32)));

  HalfLanes() = default;
  PTIN_LANES HalfLanes(Half low_lanes, Half high_lanes) noexcept
      : low(low_lanes), high(high_lanes) {}
  PTIN_LANES HalfLanes(double all) noexcept : low(Half{} + all), high(Half{} + all) {}

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

template <class Lanes>
PTIN_LANES Lanes all_lanes(double value) noexcept {
  return Lanes{} + value;
}

/// The lanes at `from`, which need not be aligned.
template <class Lanes>
PTIN_LANES Lanes load_lanes(const double* from) noexcept {
  Lanes lanes;
  __builtin_memcpy(static_cast<void*>(&lanes), from, sizeof lanes);
  return lanes;
}

template <class Lanes>
PTIN_LANES void store_lanes(double* to, const Lanes& lanes) noexcept {
  __builtin_memcpy(to, &lanes, sizeof lanes);
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

PTIN_LANES double largest_lane(HalfLanes v) noexcept {
  const HalfLanes::Half four = v.high > v.low ? v.high : v.low;
  const double a = four[0] > four[1] ? four[0] : four[1];
  const double b = four[2] > four[3] ? four[2] : four[3];
  return a > b ? a : b;
}

PTIN_LANES double largest_lane(WideLanes v) noexcept {
  using Indices = long long __attribute__((vector_size(64)));
  v = larger(__builtin_shuffle(v, Indices{4, 5, 6, 7, 0, 1, 2, 3}), v);
  v = larger(__builtin_shuffle(v, Indices{2, 3, 0, 1, 6, 7, 4, 5}), v);
  return v[0] > v[1] ? v[0] : v[1];
}

/// What loops in lanes are compiled for.
enum class LaneSet : std::uint8_t { kPlain, kAvx2, kAvx512 };
/// The most that this processor has.
[[nodiscard]] LaneSet lanes_of_processor() noexcept;
/// Has in_lanes() use no more than these, for tests of them; the processor has them.
void use_lanes(LaneSet set) noexcept;
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
