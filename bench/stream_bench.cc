// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive transmission over the store of PTIN_BENCH_STORE (or srtm1_bigtujunga), warm, in
// memory.
//   BM_Send/error:e      what a tolerance of e needs (-1: everything), splits a second;
//                        `bytes/split` counts everything that is sent
//   BM_Receive/error:e   the same bytes read in pieces of 64 KiB
// Cannot show: networks; terrains whose meshes do not fit into memory.
#include <algorithm>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/stream/stream_reader.h"
#include "engine/query/stream/stream_writer.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

StreamSummary send(std::int64_t error, std::vector<std::byte>& bytes) {
  StreamRequest request;
  if (error >= 0) {
    request.tolerance = static_cast<double>(error);
    request.wanted = error_above(*request.tolerance);
  }
  bytes.clear();
  return write_stream(OpenedTerrain(store()), request, [&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  });
}

void report(benchmark::State& state, const StreamSummary& sent) {
  state.counters["splits"] = static_cast<double>(sent.splits);
  add_mean(state, "bytes/split", sent.bytes, sent.splits);
  add_rate(state, "splits/s", sent.splits);
}

void BM_Send(benchmark::State& state) {
  if (skipped(state)) return;
  std::vector<std::byte> bytes;
  StreamSummary sent;
  for (auto _ : state) {
    sent = send(state.range(0), bytes);
  }
  report(state, sent);
}

void BM_Receive(benchmark::State& state) {
  if (skipped(state)) return;
  std::vector<std::byte> bytes;
  const StreamSummary sent = send(state.range(0), bytes);
  for (auto _ : state) {
    StreamReader reader("bench");
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t piece = std::min<std::size_t>(65536, bytes.size() - at);
      at += reader.feed(std::span(bytes).subspan(at, piece));
    }
    benchmark::DoNotOptimize(reader.tin().triangles.data());
  }
  report(state, sent);
}

#define PTIN_ERRORS \
  ->ArgName("error")->Arg(-1)->Arg(0)->Arg(5)->Arg(50)->Unit(benchmark::kMillisecond)
BENCHMARK(BM_Send) PTIN_ERRORS;
BENCHMARK(BM_Receive) PTIN_ERRORS;

}  // namespace
