// SPDX-License-Identifier: GPL-3.0-or-later
//
// What all measurements of one file share: its cache, the ways to open it, its questions. And the
// measurements.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "tools/measure/deadline.h"
#include "tools/measure/file_cache.h"
#include "tools/measure/io_report.h"
#include "tools/measure/question.h"
#include "tools/measure/read_way.h"
#include "tools/measure/system_reads.h"

namespace ptin::tools {

class IoRun {
 public:
  /// Opens the file, and finds out whether it can be made cold and what the system reports.
  /// @throws Error as Terrain::open
  explicit IoRun(const IoRequest& request);

  [[nodiscard]] const IoRequest& request() const noexcept { return request_; }
  [[nodiscard]] const FileCache& cache() const noexcept { return cache_; }
  [[nodiscard]] const Questions& questions() const noexcept { return questions_; }
  /// The ways that there are here.
  [[nodiscard]] const std::vector<ReadWay>& ways() const noexcept { return ways_; }
  /// Empty: there are cold figures.
  [[nodiscard]] const std::string& why_not_cold() const noexcept { return why_not_cold_; }
  [[nodiscard]] const std::string& why_no_uring() const noexcept { return why_no_uring_; }
  [[nodiscard]] bool has_device_bytes() const noexcept { return has_device_bytes_; }
  /// The terrain for preparations: it maps nothing, so it keeps nothing in the page cache.
  [[nodiscard]] const Terrain& unmapped() const noexcept { return unmapped_; }

  [[nodiscard]] Question make(QuestionKind kind, std::uint64_t number) const {
    return questions_.make(kind, number, unmapped_);
  }

  /// Drops the file; false when some of it stays. REQUIRES: no store maps the file.
  [[nodiscard]] bool make_cold() const { return cache_.drop() == 0; }
  /// A terrain that was opened, and what that took; the file is still the one that the run began
  /// with.
  struct Opened {
    Terrain terrain;
    Reading reading;
  };
  [[nodiscard]] Opened open(ReadWay way);
  /// Whether a file that was dropped came from the device when it was opened: else someone else had
  /// read it meanwhile.
  [[nodiscard]] bool came_from_device(const Reading& opening) const {
    return !has_device_bytes_ || opening.device_bytes.value_or(0) > 0;
  }

  /// What some work takes. `work` returns its IoCounters.
  template <class Work>
  [[nodiscard]] Reading timed(const Work& work) const {
    Reading reading;
    const SystemReads before = SystemReads::now();
    const auto begin = std::chrono::steady_clock::now();
    reading.io = work();
    reading.seconds = seconds_since(begin);
    const SystemReads reads = SystemReads::now().since(before);
    if (has_device_bytes_) reading.device_bytes = reads.device_bytes;
    reading.major_faults = reads.major_faults;
    return reading;
  }

  /// @throws Error corruption  the file is not what it was when the run began
  void check_unchanged() const { unmapped_.store().pages().check_unchanged(); }
  void tell(const char* stage, double share) const {
    if (request_.progress) request_.progress(stage, share);
  }

 private:
  [[nodiscard]] bool find_device_bytes();

  const IoRequest& request_;
  FileCache cache_;
  Terrain unmapped_;
  Questions questions_;
  TerrainOpener opener_;
  std::string why_not_cold_, why_no_uring_;
  std::vector<ReadWay> ways_;
  bool has_device_bytes_ = false;
};

/// Fills `opening` and `questions` of a report, for about `seconds`: every kind of question by every
/// way. A round of a kind asks one question by each way, each at a place of its own: no way finds a
/// place in a cache below the system's because another way has asked there. The kind that has had the
/// least time is next.
///
/// A cold reading: the file is dropped, seen to be gone, opened and asked once. The warm reading asks
/// the same once more; there is none by io_uring, which a warm question does not use.
/// @throws Error corruption  the file was changed; cancelled, io_error
void run_questions(IoRun& run, double seconds, IoReport& report);

/// Fills `threads` of a report, for about `seconds`: points and windows of 1/10 000 by every way on
/// 1, 2, 4 ... threads, on one opened file. A cold run drops the file, opens it, and lets the threads
/// take so many questions, each at a place of its own; the warm run asks the same ones again, several
/// times where they take no time.
/// REQUIRES: run_questions() filled `questions`: a kind that it left out is left out here.
/// @throws Error as run_questions()
void run_threads(IoRun& run, double seconds, IoReport& report);

/// Fills `index` of a report, for about `seconds`: which pages hold the records of points and
/// windows, found by the packed R-tree and by libspatialindex's, and not read. The second index is
/// built first, in a folder of its own that goes with the call; it is left out where sorting the
/// pages' boxes takes more than the request's memory. Cold: the file and the second index are dropped
/// and opened again; opening is not measured.
/// @throws Error as run_questions(); internal  the two find different pages
void run_indexes(IoRun& run, double seconds, IoReport& report);

}  // namespace ptin::tools
