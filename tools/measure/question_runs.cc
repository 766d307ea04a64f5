// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/measure/io_run.h"
#include "tools/measure/part_time.h"

namespace ptin::tools {

namespace {

/// The rounds of one kind of question.
struct Rounds {
  QuestionKind kind;
  std::size_t first_row;  ///< First of its rows in the report, one a way.
  std::uint64_t done = 0;
  double seconds = 0.0;
  bool is_over = false;
};

class QuestionRuns {
 public:
  QuestionRuns(IoRun& run, double seconds, IoReport& report)
      : run_(run), report_(report), time_(run.request(), seconds) {
    for (const ReadWay way : run_.ways()) report_.opening.push_back({way, {}});
    for (const QuestionKind kind : kQuestionKinds) {
      kinds_.push_back({kind, report_.questions.size()});
      for (const ReadWay way : run_.ways()) report_.questions.push_back({kind, way, {}, {}, {}});
    }
  }

  void run() {
    while (Rounds* const next = next_kind()) {
      const double before = time_.elapsed();
      round(*next);
      next->seconds += time_.elapsed() - before;
      run_.tell("questions", time_.share());
    }
    tell_what_is_missing();
  }

 private:
  Rounds* next_kind();
  void round(Rounds& rounds);
  void read(const Question& question, std::size_t way, QuestionFigures& figures);
  void leave_out(Rounds& rounds, const std::string& why);
  void tell_what_is_missing();

  IoRun& run_;
  IoReport& report_;
  PartTime time_;
  std::vector<Rounds> kinds_;
};

/// Every kind has a first round, however late it is.
Rounds* QuestionRuns::next_kind() {
  if (time_.is_over()) return nullptr;
  const bool is_late = time_.is_late();
  Rounds* next = nullptr;
  for (Rounds& k : kinds_) {
    const bool is_open = !k.is_over && k.done < run_.request().most_times;
    if (!is_open || (is_late && k.done > 0)) continue;
    if (next == nullptr || k.seconds < next->seconds) next = &k;
  }
  return next;
}

void QuestionRuns::round(Rounds& rounds) {
  const std::size_t ways = run_.ways().size();
  try {
    for (std::size_t i = 0; i < ways; ++i) {
      // Another way comes first in each round.
      const std::size_t way = (rounds.done + i) % ways;
      const Question question = run_.make(rounds.kind, rounds.done * ways + way);
      read(question, way, report_.questions[rounds.first_row + way]);
      run_.check_unchanged();
    }
  } catch (const Error& e) {
    const bool is_too_large = e.code() == ErrorCode::resource_exhausted;
    const bool is_too_long = e.code() == ErrorCode::cancelled && time_.is_over();
    if (!is_too_large && !is_too_long) throw;
    if (is_too_large) leave_out(rounds, "it needs more memory than --memory gives");
    rounds.is_over = true;
  }
  ++rounds.done;
}

void QuestionRuns::read(const Question& question, std::size_t way, QuestionFigures& figures) {
  const bool wants_cold = run_.why_not_cold().empty();
  bool is_cold = wants_cold && run_.make_cold();
  const IoRun::Opened opened = run_.open(figures.way);
  is_cold = is_cold && run_.came_from_device(opened.reading);
  Answer answer, again;
  const auto ask = [&](Answer& into) {
    into = run_.questions().ask(question, opened.terrain, time_.limits());
    return into.cost.io;
  };
  Reading first = run_.timed([&] { return ask(answer); });
  first.least_bytes = run_.questions().least_bytes(question, answer);
  if (is_cold) {
    report_.opening[way].cold.add(opened.reading);
    figures.cold.add(first);
  } else if (wants_cold) {
    report_.opening[way].cold.add_not_cold();
    figures.cold.add_not_cold();
  }
  if (figures.way == ReadWay::kUring) return;
  Reading second = run_.timed([&] { return ask(again); });
  second.least_bytes = first.least_bytes;
  figures.warm.add(second);
  if (again.digest != answer.digest)
    throw Error(ErrorCode::internal, "the same question had two answers", run_.request().file);
}

/// Places that need less are not measured alone: they would not stand for all.
void QuestionRuns::leave_out(Rounds& rounds, const std::string& why) {
  for (std::size_t i = 0; i < run_.ways().size(); ++i) {
    QuestionFigures& figures = report_.questions[rounds.first_row + i];
    figures.cold = figures.warm = {};
    figures.why_left_out = why;
  }
}

void QuestionRuns::tell_what_is_missing() {
  stop_if_asked(run_.request().stop, "the benchmark", run_.request().file);
  for (QuestionFigures& f : report_.questions) {
    const bool is_empty = f.cold.all().empty() && f.warm.all().empty() && f.cold.not_cold() == 0;
    if (is_empty && f.why_left_out.empty())
      f.why_left_out = "it takes longer than --seconds leaves for it";
  }
}

}  // namespace

void run_questions(IoRun& run, double seconds, IoReport& report) {
  QuestionRuns(run, seconds, report).run();
}

}  // namespace ptin::tools
