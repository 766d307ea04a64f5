// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <latch>
#include <mutex>
#include <span>
#include <thread>
#include <utility>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/measure/io_run.h"
#include "tools/measure/part_time.h"

namespace ptin::tools {

namespace {

constexpr std::array kKindsOnThreads = {QuestionKind::kPoint, QuestionKind::kWindow10000th};
// Places of the runs on threads are others than those of single questions.
constexpr std::uint64_t kFirstNumber = std::uint64_t{1} << 32;

/// So many questions that one thread takes about a tenth of a second for them, cold.
std::uint64_t questions_of_run(const IoReport& report, QuestionKind kind) {
  constexpr double kSeconds = 0.1;
  const auto figures = std::find_if(report.questions.begin(), report.questions.end(),
                                    [&](const QuestionFigures& f) { return f.kind == kind; });
  if (figures == report.questions.end() || !figures->why_left_out.empty()) return 0;
  const Readings& readings = figures->cold.all().empty() ? figures->warm : figures->cold;
  const double one = readings.seconds().median.value_or(kSeconds);
  return static_cast<std::uint64_t>(std::clamp(kSeconds / std::max(one, 1e-6), 8.0, 256.0));
}

class ThreadRuns {
 public:
  ThreadRuns(IoRun& run, double seconds, IoReport& report)
      : run_(run), report_(report), time_(run.request(), seconds) {
    for (const QuestionKind kind : kKindsOnThreads) {
      const std::uint64_t questions = questions_of_run(report, kind);
      if (questions == 0) continue;
      for (const ReadWay way : run_.ways()) {
        for (int threads = 1;; threads = std::min(2 * threads, run_.request().most_threads)) {
          report_.threads.push_back({kind, way, threads, questions, {}, {}, 0});
          if (threads == run_.request().most_threads) break;
        }
      }
    }
  }

  void run() {
    run_.tell("threads", time_.share());
    try {
      for (std::uint64_t round = 0; goes_on(round); ++round) {
        for (std::size_t i = 0; i < report_.threads.size(); ++i) {
          const std::size_t at = (i + round) % report_.threads.size();
          run_once(report_.threads[at], kFirstNumber + numbers_);
          numbers_ += report_.threads[at].questions;
          run_.check_unchanged();
          run_.tell("threads", time_.share());
        }
      }
    } catch (const Error& e) {
      const bool is_too_long = e.code() == ErrorCode::cancelled && time_.is_over();
      if (!is_too_long && e.code() != ErrorCode::resource_exhausted) throw;
    }
    stop_if_asked(run_.request().stop, "the benchmark", run_.request().file);
  }

 private:
  [[nodiscard]] bool goes_on(std::uint64_t round) const {
    if (time_.is_over() || report_.threads.empty()) return false;
    return round == 0 || (round < run_.request().most_times && !time_.is_late());
  }
  void run_once(ThreadFigures& figures, std::uint64_t first_number);
  double ask_all(const ThreadFigures& figures, std::span<const Question> questions,
                 const Terrain& terrain, std::uint64_t times) const;

  IoRun& run_;
  IoReport& report_;
  PartTime time_;
  std::uint64_t numbers_ = 0;  ///< Number of questions asked.
};

void ThreadRuns::run_once(ThreadFigures& figures, std::uint64_t first_number) {
  std::vector<Question> questions;
  for (std::uint64_t i = 0; i < figures.questions; ++i) {
    questions.push_back(run_.make(figures.kind, first_number + i));
  }
  const bool wants_cold = run_.why_not_cold().empty();
  bool is_cold = wants_cold && run_.make_cold();
  const IoRun::Opened opened = run_.open(figures.way);
  is_cold = is_cold && run_.came_from_device(opened.reading);
  const auto count = static_cast<double>(questions.size());
  const double seconds = ask_all(figures, questions, opened.terrain, 1);
  if (is_cold) figures.cold_per_second.push_back(count / seconds);
  if (wants_cold && !is_cold) ++figures.not_cold;
  if (figures.way == ReadWay::kUring) return;
  constexpr double kLongEnough = 0.05;
  const double once = ask_all(figures, questions, opened.terrain, 1);
  const double times = std::clamp(std::ceil(kLongEnough / std::max(once, 1e-6)), 1.0, 256.0);
  const double all = ask_all(figures, questions, opened.terrain, static_cast<std::uint64_t>(times));
  figures.warm_per_second.push_back(times * count / all);
}

/// Seconds from when all threads are there to when the last is done.
/// @param times  How often each question is asked.
double ThreadRuns::ask_all(const ThreadFigures& figures, std::span<const Question> questions,
                           const Terrain& terrain, std::uint64_t times) const {
  std::atomic<std::uint64_t> next{0};
  std::exception_ptr failure;
  std::mutex lock;
  std::latch all_here(figures.threads + 1);
  const auto work = [&] {
    all_here.arrive_and_wait();
    try {
      for (std::uint64_t i = next++; i < times * questions.size(); i = next++) {
        static_cast<void>(
            run_.questions().ask(questions[i % questions.size()], terrain, time_.limits()));
      }
    } catch (...) {
      next = times * questions.size();
      const std::lock_guard held(lock);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::jthread> threads;
  try {
    for (int i = 0; i < figures.threads; ++i) threads.emplace_back(work);
  } catch (...) {  // the system gives no more threads: those that are there must not wait
    next = times * questions.size();
    all_here.count_down(figures.threads + 1 - static_cast<std::ptrdiff_t>(threads.size()));
    throw;
  }
  all_here.arrive_and_wait();
  const auto begin = std::chrono::steady_clock::now();
  threads.clear();
  const double seconds = seconds_since(begin);
  if (failure) std::rethrow_exception(failure);
  return seconds;
}

}  // namespace

void run_threads(IoRun& run, double seconds, IoReport& report) {
  ThreadRuns(run, seconds, report).run();
}

}  // namespace ptin::tools
