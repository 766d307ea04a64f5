// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a query carries along: its costs, its limits and its stop token.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <utility>

#include "storage/file/io_counters.h"

namespace ptin {

/// What an answer cost (promise P9). Counted in the query's own context.
struct QueryCost {
  /// Records of the pages read for which the predicate is true.
  std::uint64_t records_retrieved = 0;
  std::uint64_t records_examined = 0;  ///< Records decoded and asked.
  std::uint64_t records_applied = 0;   ///< Splits made.
  IoCounters io;
  double seconds = 0.0;

  /// Adds what a part of the answer cost; `seconds` is the whole answer's, and left alone.
  void add_counts(const QueryCost& part) noexcept;
};

/// Steps of a long loop between two looks at the stop token.
inline constexpr std::size_t kStopInterval = 4096;

/// The context of one query. Every step of it is handed the same one; nothing of it is shared
/// between queries. Threads: none; one query, one thread.
class QueryContext {
 public:
  /// @param stop                Looked at in every long loop.
  /// @param memory_limit_bytes  For records and mesh together.
  /// @param file                Named in errors.
  QueryContext(std::stop_token stop, std::uint64_t memory_limit_bytes, std::string file)
      : stop_(std::move(stop)), memory_limit_bytes_(memory_limit_bytes), file_(std::move(file)) {}

  /// @throws Error cancelled when the stop token fired.
  void check_stop() const {
    if (stop_.stop_requested()) [[unlikely]] {
      throw_cancelled();
    }
  }

  /// @param bytes  What the query would hold at its largest, as far as the index can tell.
  /// @throws Error resource_exhausted when that exceeds the limit; names both figures and `export`.
  void admit(std::uint64_t bytes) const {
    if (bytes > memory_limit_bytes_) [[unlikely]] {
      throw_exhausted(bytes);
    }
  }

  /// The limit of a part of the query that keeps account of itself, while the query holds `bytes`.
  /// @throws Error as admit()
  [[nodiscard]] std::uint64_t left_beside(std::uint64_t bytes) const {
    admit(bytes);
    return memory_limit_bytes_ - bytes;
  }

  [[nodiscard]] const std::string& file() const noexcept { return file_; }

  QueryCost cost;

 private:
  [[noreturn]] void throw_cancelled() const;
  [[noreturn]] void throw_exhausted(std::uint64_t bytes) const;

  std::stop_token stop_;
  std::uint64_t memory_limit_bytes_;
  std::string file_;
};

}  // namespace ptin
