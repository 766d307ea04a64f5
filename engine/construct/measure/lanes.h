// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vectors of doubles for the measuring loops, as wide as kSampleLanes.
//
// Comparisons in these loops are one `<` on the smaller of two values: two joined by `&` are taken
// apart lane by lane by gcc 12.
#pragma once

#include "engine/construct/measure/star_samples.h"

// The loader chooses the version of a function once. Sanitizers run before it may choose, so builds
// with them have the plain version alone.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__x86_64__)
#define PTIN_VERSIONS
#else
#define PTIN_VERSIONS __attribute__((target_clones("avx512f", "avx2", "default")))
#endif

namespace ptin {

using Lanes = double __attribute__((vector_size(kSampleLanes * sizeof(double))));
using LaneIndices = long long __attribute__((vector_size(kSampleLanes * sizeof(long long))));

// Always inlined, and so compiled for the version of its caller: an inline function that stands for
// itself has one version only.
#define PTIN_LANES inline __attribute__((always_inline))

PTIN_LANES Lanes load_lanes(const double* from) noexcept {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

PTIN_LANES void store_lanes(double* to, const Lanes& lanes) noexcept {
  __builtin_memcpy(to, &lanes, sizeof lanes);
}

PTIN_LANES Lanes smaller(const Lanes& a, const Lanes& b) noexcept { return b < a ? b : a; }
PTIN_LANES Lanes larger(const Lanes& a, const Lanes& b) noexcept { return b > a ? b : a; }
PTIN_LANES Lanes magnitude(const Lanes& a) noexcept { return a < 0.0 ? -a : a; }

PTIN_LANES double largest_lane(Lanes v) noexcept {
  v = larger(__builtin_shuffle(v, LaneIndices{4, 5, 6, 7, 0, 1, 2, 3}), v);
  v = larger(__builtin_shuffle(v, LaneIndices{2, 3, 0, 1, 6, 7, 4, 5}), v);
  return v[0] > v[1] ? v[0] : v[1];
}

}  // namespace ptin
