// SPDX-License-Identifier: GPL-3.0-or-later
//
// The two kinds of counters of benchmarks.
#pragma once

#include <benchmark/benchmark.h>

namespace ptin::bench {

/// So much an iteration, told as a rate: of processor time, of the clock where the benchmark says so.
template <class Amount>
void add_rate(benchmark::State& state, const char* name, Amount amount) {
  state.counters[name] = benchmark::Counter(static_cast<double>(amount),
                                            benchmark::Counter::kIsIterationInvariantRate);
}

/// The mean of a total over `count` questions, moves or the like.
template <class Total, class Count>
void add_mean(benchmark::State& state, const char* name, Total total, Count count) {
  state.counters[name] = static_cast<double>(total) / static_cast<double>(count);
}

}  // namespace ptin::bench
