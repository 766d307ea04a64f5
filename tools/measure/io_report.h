// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is asked of a measurement of input and output, and what it finds.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/memory_units.h"
#include "storage/file/io_counters.h"
#include "tools/measure/device_speed.h"
#include "tools/measure/quantiles.h"
#include "tools/measure/question.h"
#include "tools/measure/read_way.h"

namespace ptin::tools {

struct IoRequest {
  std::string file;
  std::uint64_t seed = 1;
  /// About how long all of it takes. It may take twice as long: a question that is under way is
  /// finished, unless it lasts beyond that.
  double seconds = 60.0;
  std::uint64_t most_times = 200;   ///< Most runs of a question by each way; >= 1.
  int most_threads = 1;             ///< >= 1.
  std::optional<double> tolerance;  ///< As DetailRequest::tolerance, of every question.
  std::uint64_t memory_bytes = kMemoryOfQuestion;  ///< For a question, and for the second index.
  /// Where the second index is for as long as it is measured. Empty: beside the file.
  std::string temporary_folder;
  std::stop_token stop;
  /// Called with a stage and its share done, 0 to 1; may throw. None: it is not.
  std::function<void(const char* stage, double share)> progress;
};

/// What one question took.
struct Reading {
  double seconds = 0.0;  ///< On the clock.
  IoCounters io;         ///< What the question counted; of opening nothing.
  std::optional<std::uint64_t> device_bytes;
  std::uint64_t major_faults = 0;
  std::uint64_t least_bytes = 0;  ///< Questions::least_bytes(); 0: it is not asked.
};

/// Readings of the same question at many places.
class Readings {
 public:
  void add(const Reading& reading) { all_.push_back(reading); }
  /// Counts a reading that was to be cold, and was not: it is in no figure.
  void add_not_cold() { ++not_cold_; }

  [[nodiscard]] const std::vector<Reading>& all() const noexcept { return all_; }
  [[nodiscard]] std::uint64_t not_cold() const noexcept { return not_cold_; }
  [[nodiscard]] Quantiles seconds() const;
  [[nodiscard]] double mean_pages() const;  ///< Means of no reading are 0.
  [[nodiscard]] double mean_nodes() const;
  [[nodiscard]] double mean_asked_bytes() const;  ///< Pages and nodes that were read.
  /// Those bytes over the least that hold the answers; none where that is not asked.
  [[nodiscard]] std::optional<double> asked_over_least() const;
  [[nodiscard]] double mean_major_faults() const;
  /// None where the system does not say, or there is no reading.
  [[nodiscard]] std::optional<double> mean_device_bytes() const;

 private:
  template <class Value>
  [[nodiscard]] double mean_of(const Value& value) const;

  std::vector<Reading> all_;
  std::uint64_t not_cold_ = 0;
};

/// One kind of question by one way.
struct QuestionFigures {
  QuestionKind kind = QuestionKind::kPoint;
  ReadWay way = ReadWay::kAnnounced;
  Readings cold, warm;
  std::string why_left_out;  ///< Empty: it is not.
};

/// Opening the file, cold, by one way.
struct OpeningFigures {
  ReadWay way = ReadWay::kAnnounced;
  Readings cold;
};

/// Many questions of one kind, asked by several threads at once on one opened file.
struct ThreadFigures {
  QuestionKind kind = QuestionKind::kPoint;
  ReadWay way = ReadWay::kAnnounced;
  int threads = 1;
  std::uint64_t questions = 0;                           ///< Questions of one run.
  std::vector<double> cold_per_second, warm_per_second;  ///< Questions; one number a run.
  std::uint64_t not_cold = 0;                            ///< Runs that are in no figure.
};

/// Searches of an index, without reading the pages that it names.
struct SearchFigures {
  QuestionKind kind = QuestionKind::kPoint;
  bool is_second = false;  ///< By libspatialindex; else by the packed R-tree.
  Readings cold, warm;
};
struct IndexFigures {
  std::vector<SearchFigures> searches;
  std::string why_no_second;       ///< Empty: there is a second index.
  double build_seconds = 0.0;      ///< Time to build the second index.
  std::uint64_t bytes = 0;         ///< Its files.
  std::uint64_t packed_bytes = 0;  ///< Bytes of the packed R-tree in the file.
  std::string why_not_cold;        ///< Why the second index was not cold; empty: it was.
};

struct IoReport {
  std::uint64_t file_bytes = 0;
  std::string file_system;  ///< Empty: unknown.
  std::optional<DeviceSpeed> device;
  std::string why_not_cold;       ///< Empty: cold figures are there.
  std::string why_no_uring;       ///< Empty: figures of io_uring are there.
  bool has_device_bytes = false;  ///< The system reports what it reads from the device.
  std::vector<OpeningFigures> opening;
  std::vector<QuestionFigures> questions;
  std::vector<ThreadFigures> threads;
  IndexFigures index;
  double seconds = 0.0;  ///< All of it, on the clock.
};

}  // namespace ptin::tools
