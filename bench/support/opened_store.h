// SPDX-License-Identifier: GPL-3.0-or-later
//
// The store that benchmarks of queries ask, opened once.
#pragma once

#include <memory>

#include <benchmark/benchmark.h>

#include "bench/support/counters.h"
#include "bench/support/places.h"
#include "bench/support/scratch.h"
#include "engine/query/questions.h"

namespace ptin::bench {

/// bench_store(), opened; null when there is no such store.
inline const std::shared_ptr<const StoreFile>& store() {
  static const std::shared_ptr<const StoreFile> file =
      bench_store().empty() ? nullptr : StoreFile::open(bench_store());
  return file;
}

/// store() as a terrain that answers questions; null when there is no such store.
inline const Terrain* terrain() {
  if (store() == nullptr) return nullptr;
  static const Terrain opened(store());
  return &opened;
}

/// The facts of store(). REQUIRES: there is one.
inline const StoreFacts& facts() { return store()->facts(); }

/// True when there is no store to ask; the results of the benchmark then say what it needs.
inline bool skipped(benchmark::State& state) {
  if (store() != nullptr) return false;
  state.SkipWithError("needs PTIN_BENCH_STORE or srtm1_bigtujunga_utm_1197x643.tif");
  return true;
}

}  // namespace ptin::bench
