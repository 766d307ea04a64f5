// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a query carries along: its costs, its limits and its stop token.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "engine/query/select/query_limits.h"
#include "engine/stop.h"
#include "storage/file/io_counters.h"

namespace ptin {

class SampleHeights;

/// What an answer cost (promise P9). Counted in the query's own context.
struct QueryCost {
  /// Records of the pages read for which the predicate is true.
  std::uint64_t records_retrieved = 0;
  std::uint64_t records_examined = 0;  ///< Records decoded and tested by the predicate.
  std::uint64_t records_applied = 0;   ///< Splits made.
  /// Stars decoded, each with all its triangles: those of the pages read that may hold what was
  /// asked for.
  std::uint64_t stars_read = 0;
  /// Samples of a raster's heights decoded: those of the tiles read.
  std::uint64_t samples_read = 0;
  IoCounters io;
  double seconds = 0.0;  ///< Elapsed time of the answer.

  /// Records, or samples of a raster, that were looked at.
  [[nodiscard]] std::uint64_t examined() const noexcept { return records_examined + samples_read; }

  /// Adds the counts of a part of the answer. `seconds` is left alone: it is the time of the whole
  /// answer.
  void add_counts(const QueryCost& part) noexcept;
};

/// Seconds on the clock.
[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The answer that answer() gives, with the time that it took in its cost.
template <class Answer>
[[nodiscard]] auto timed(const Answer& answer) {
  const auto start = std::chrono::steady_clock::now();
  auto result = answer();
  result.cost.seconds = seconds_since(start);
  return result;
}

/// The context of one query. Every step of the query is handed the same context, and no two queries
/// share one. Threads: one; a query runs on one thread.
class QueryContext {
 public:
  /// @param file  Named in errors.
  QueryContext(QueryLimits limits, std::string file)
      : limits_(std::move(limits)), file_(std::move(file)) {}

  /// @throws Error cancelled when the stop token fired.
  void check_stop() const {
    if (limits_.stop.stop_requested()) [[unlikely]] {
      throw_cancelled();
    }
  }

  /// @param bytes  Most bytes that the query will hold, as far as the index can tell.
  /// @throws Error resource_exhausted when `bytes` exceeds the limit; names both figures and
  /// `export`.
  void admit(std::uint64_t bytes) const {
    if (!fits(bytes)) [[unlikely]] {
      throw_exhausted(bytes);
    }
  }

  /// From now on the query holds so many bytes besides what admit() is told, in the place of those
  /// that it was told to hold before.
  /// @throws Error as admit()
  void hold(std::uint64_t bytes) {
    held_ = 0;
    admit(bytes);
    held_ = bytes;
  }

  /// Whether admit() would let so many bytes in.
  [[nodiscard]] bool fits(std::uint64_t bytes) const noexcept {
    return bytes <= limits_.memory_bytes - held_;
  }

  /// What the limit leaves beside `bytes` that the query holds: the limit for a part of the query
  /// that has a context of its own.
  /// @throws Error as admit()
  [[nodiscard]] std::uint64_t left_beside(std::uint64_t bytes) const {
    admit(bytes);
    return limits_.memory_bytes - held_ - bytes;
  }

  [[nodiscard]] const std::string& file() const noexcept { return file_; }

  /// Those of vertices of local pages. What they take, at most half a MB, is not counted in what the query
  /// holds, as the bytes of the page that is looked at are not.
  [[nodiscard]] SampleHeights& heights();

  QueryCost cost;

 private:
  [[noreturn]] void throw_cancelled() const;
  [[noreturn]] void throw_exhausted(std::uint64_t bytes) const;

  /// A copy of a context begins with none: it may be another thread's.
  struct OwnHeights {
    OwnHeights() noexcept;
    OwnHeights(const OwnHeights&) noexcept;
    OwnHeights(OwnHeights&&) noexcept;
    OwnHeights& operator=(const OwnHeights&) noexcept;
    OwnHeights& operator=(OwnHeights&&) noexcept;
    ~OwnHeights();
    std::unique_ptr<SampleHeights> kept;
  };

  QueryLimits limits_;
  std::uint64_t held_ = 0;  ///< At most the limit.
  OwnHeights heights_;
  std::string file_;
};

}  // namespace ptin
