// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cerrno>
#include <memory>
#include <optional>
#include <utility>

#include <stdlib.h>

#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/file_questions.h"
#include "storage/index_shape.h"
#include "tools/facts/human.h"
#include "tools/measure/io_run.h"
#include "tools/measure/part_time.h"
#include "tools/output/temporary_path.h"
#include "tools/second_index.h"

namespace ptin::tools {

namespace {

constexpr std::array kKindsOfSearches = {QuestionKind::kPoint, QuestionKind::kWindow10000th,
                                         QuestionKind::kWindow400th, QuestionKind::kWindow25th};
constexpr std::uint64_t kSortedPageBytes = 256;  // what the bulk loader keeps of a page

std::string make_folder_in(const std::string& parent) {
  std::string name = parent + "/.ptin-bench-XXXXXX";
  if (::mkdtemp(name.data()) == nullptr)
    throw system_error(errno, "cannot make a folder for the second index", parent);
  return name;
}

/// libspatialindex's tree of a file, in a folder that goes with the object.
class SecondIndex {
 public:
  /// @throws Error io_error, not_found, resource_exhausted
  SecondIndex(const IoRequest& request, const std::shared_ptr<const StoreFile>& store)
      : folder_(make_folder_in(request.temporary_folder.empty() ? folder_of(request.file)
                                                                : request.temporary_folder)) {
    const auto begin = std::chrono::steady_clock::now();
    static_cast<void>(open(store, request.memory_bytes));
    build_seconds = seconds_since(begin);
    for (const char* end : {".dat", ".idx"}) {
      caches_.push_back(std::make_unique<FileCache>(base() + end));
      bytes += caches_.back()->file_bytes();
    }
  }

  [[nodiscard]] std::unique_ptr<RecordIndex> open(const std::shared_ptr<const StoreFile>& store,
                                                  std::uint64_t memory_bytes) const {
    SpatialIndexOptions options;
    options.base = base();
    options.memory_bytes = memory_bytes;
    return open_second_index(store, options);
  }
  [[nodiscard]] std::string why_not_cold(const FileCache& file) const {
    for (const auto& cache : caches_) {
      if (!cache->is_beside(file)) return "it lies on another file system than the file";
      if (std::string why = cache->why_never_cold(); !why.empty()) return why;
    }
    return {};
  }
  [[nodiscard]] bool make_cold() const {
    return std::all_of(caches_.begin(), caches_.end(),
                       [](const auto& cache) { return cache->drop() == 0; });
  }

  double build_seconds = 0.0;
  std::uint64_t bytes = 0;

 private:
  [[nodiscard]] std::string base() const { return folder_.path() + "/tree"; }

  TemporaryPath folder_;
  std::vector<std::unique_ptr<FileCache>> caches_;
};

class IndexRuns {
 public:
  IndexRuns(IoRun& run, double seconds, IoReport& report)
      : run_(run), report_(report.index), time_(run.request(), seconds) {
    const StoreFile& store = run_.unmapped().store();
    const std::uint64_t pages = store.pages().page_count();
    report_.packed_bytes = store.index_shape().total_bytes();
    make_second(pages);
    for (const QuestionKind kind : kKindsOfSearches) {
      for (const bool is_second : {false, true}) {
        if (!is_second || second_) report_.searches.push_back({kind, is_second, {}, {}});
      }
    }
  }

  void run() {
    const auto goes_on = [&](std::uint64_t round) {
      return round == 0 || (round < run_.request().most_times && !time_.is_late());
    };
    for (std::uint64_t round = 0; !time_.is_over() && goes_on(round); ++round) {
      for (std::size_t i = 0; i < report_.searches.size() && !time_.is_over(); ++i) {
        stop_if_asked(run_.request().stop, "the benchmark", run_.request().file);
        search(report_.searches[i], 2 * round + (report_.searches[i].is_second ? 1 : 0));
        run_.check_unchanged();
        run_.tell("indexes", time_.share());
      }
    }
    stop_if_asked(run_.request().stop, "the benchmark", run_.request().file);
  }

 private:
  void make_second(std::uint64_t pages);
  void search(SearchFigures& figures, std::uint64_t number);

  IoRun& run_;
  IndexFigures& report_;
  PartTime time_;
  std::optional<SecondIndex> second_;
};

void IndexRuns::make_second(std::uint64_t pages) {
  const IoRequest& request = run_.request();
  if (pages * kSortedPageBytes > request.memory_bytes) {
    report_.why_no_second = "sorting the boxes of its pages takes " +
                            human_bytes(pages * kSortedPageBytes) + ", more than --memory gives";
    return;
  }
  try {
    second_.emplace(request, StoreFile::open(request.file, PageAccess::kPread));
  } catch (const Error& e) {
    if (e.code() == ErrorCode::corruption) throw;
    report_.why_no_second = std::string(e.what()) + "; --tmp names another folder";
    return;
  }
  report_.build_seconds = second_->build_seconds;
  report_.bytes = second_->bytes;
  report_.why_not_cold = run_.why_not_cold().empty() ? second_->why_not_cold(run_.cache()) : "";
}

void IndexRuns::search(SearchFigures& figures, std::uint64_t number) {
  const PredicatePtr predicate = run_.questions().predicate(run_.make(figures.kind, number));
  const bool wants_cold =
      run_.why_not_cold().empty() && (!figures.is_second || report_.why_not_cold.empty());
  bool is_cold = wants_cold && run_.make_cold() && (!figures.is_second || second_->make_cold());
  const auto store = StoreFile::open(run_.request().file);
  run_.check_unchanged();
  const std::unique_ptr<RecordIndex> second =
      figures.is_second ? second_->open(store, run_.request().memory_bytes) : nullptr;
  const RecordIndex& index = second ? static_cast<const RecordIndex&>(*second) : store->index();
  std::vector<PageId> pages, again;
  const auto search_into = [&](std::vector<PageId>& found) {
    IoCounters counters;
    index.search(*predicate, found, counters);
    return counters;
  };
  const Reading first = run_.timed([&] { return search_into(pages); });
  if (is_cold) figures.cold.add(first);
  if (wants_cold && !is_cold) figures.cold.add_not_cold();
  figures.warm.add(run_.timed([&] { return search_into(again); }));
  IoCounters ignored;
  again.clear();
  store->index().search(*predicate, again, ignored);
  if (pages != again)
    throw Error(ErrorCode::internal, "the two indexes find different pages", run_.request().file);
}

}  // namespace

void run_indexes(IoRun& run, double seconds, IoReport& report) {
  IndexRuns(run, seconds, report).run();
}

}  // namespace ptin::tools
