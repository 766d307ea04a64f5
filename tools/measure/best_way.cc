// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/best_way.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr double kWorthTelling = 1.05, kWidestTie = 1.1;  // ratios

/// The logarithm of a median, and the square of its error, since only so many places were asked.
struct LogMedian {
  double log = 0.0;
  double error_square = 0.0;
};

/// None where there is no reading.
std::optional<LogMedian> log_median_of(const Readings& readings) {
  const auto median = readings.seconds().median;
  if (!median) return {};
  const auto log_of = [](double seconds) { return std::log(std::max(seconds, 1e-9)); };
  const auto n = static_cast<double>(readings.all().size());
  double mean = 0.0;
  for (const Reading& r : readings.all()) mean += log_of(r.seconds) / n;
  double squares = 0.0;
  for (const Reading& r : readings.all()) {
    squares += (log_of(r.seconds) - mean) * (log_of(r.seconds) - mean);
  }
  // One or two places do not show how far others are from them: by a factor of e, say.
  const double spread = n < 3 ? 1.0 : squares / (n - 1);
  constexpr double kMedianOverMean = 1.5708;  // of the squares of their errors, of normal values
  return LogMedian{log_of(*median), kMedianOverMean * spread / n};
}

/// One way, with what each kind takes that decides, in the order of the kinds.
struct WayTimes {
  ReadWay way;
  std::vector<LogMedian> kinds;
};

/// Adds a kind, if each way has readings of it.
void add_kind(const IoReport& report, QuestionKind kind, bool cold, std::vector<WayTimes>& ways) {
  std::vector<LogMedian> added;
  for (const WayTimes& times : ways) {
    const auto row = std::find_if(
        report.questions.begin(), report.questions.end(),
        [&](const QuestionFigures& f) { return f.kind == kind && f.way == times.way; });
    if (row == report.questions.end()) return;
    const auto median = log_median_of(cold ? row->cold : row->warm);
    if (!median) return;
    added.push_back(*median);
  }
  for (std::size_t i = 0; i < ways.size(); ++i) ways[i].kinds.push_back(added[i]);
}

/// How many errors of a mean of `n` values, whose spread is known by themselves alone, hold its
/// truth with 95 %: Student's t.
double errors_of_95_percent(std::size_t n) {
  constexpr std::array kOfDegrees = {12.706, 4.303, 3.182, 2.776, 2.571};
  static_assert(kOfDegrees.size() + 1 == kQuestionKinds.size());
  return kOfDegrees[n - 2];
}

WayRatio ratio_of(const WayTimes& way, const WayTimes& other) {
  const std::size_t kinds = way.kinds.size();
  const auto n = static_cast<double>(kinds);
  WayRatio ratio{way.way};
  std::vector<double> logs;
  double mean = 0.0, error_square = 0.0;
  bool is_one_less = false, is_one_more = false;
  for (std::size_t k = 0; k < kinds; ++k) {
    const double log = way.kinds[k].log - other.kinds[k].log;
    const double square = way.kinds[k].error_square + other.kinds[k].error_square;
    const double clear = std::max(std::log(kWorthTelling), 2 * std::sqrt(square));
    is_one_less = is_one_less || log < -clear;
    is_one_more = is_one_more || log > clear;
    if (log < 0) ++ratio.kinds_less;
    mean += log / n;
    error_square += square / (n * n);
    logs.push_back(log);
  }
  ratio.depends_on_kind = is_one_less && is_one_more;
  double error = 2 * std::sqrt(error_square);
  if (kinds >= 3) {
    double squares = 0.0;
    for (const double log : logs) squares += (log - mean) * (log - mean);
    error = std::min(error, errors_of_95_percent(kinds) * std::sqrt(squares / (n - 1) / n));
  }
  ratio.ratio = std::exp(mean);
  ratio.at_least = std::exp(mean - error);
  ratio.at_most = std::exp(mean + error);
  return ratio;
}

std::string two_decimals(double value) { return short_number(std::round(100 * value) / 100); }

/// "35 % longer", "20 % less", "3.5 times as long"; of 1 "as long".
std::string compared(double ratio) {
  if (ratio >= 2) return short_number(std::round(10 * ratio) / 10) + " times as long";
  const long percent = std::lround(std::abs(ratio - 1) * 100);
  if (percent == 0) return "as long";
  return std::to_string(percent) + " % " + (ratio > 1 ? "longer" : "less");
}

/// "pread takes 35 % longer (1.2 to 1.5 times, less in 0 of 6 kinds)".
std::string told(const WayRatio& other, std::size_t kinds) {
  const bool is_faults = other.way == ReadWay::kFaults;
  std::string text = is_faults ? "faults without announcements" : name_of(other.way);
  text += other.way == ReadWay::kUring ? " would take " : (is_faults ? " take " : " takes ");
  text += compared(other.ratio) + " (";
  if (other.verdict() == Verdict::kTie) text += "a tie: ";
  if (other.verdict() == Verdict::kUndecided) text += "not decided: ";
  return text + two_decimals(other.at_least) + " to " + two_decimals(other.at_most) +
         " times, less in " + std::to_string(other.kinds_less) + " of " + counted(kinds, "kind") +
         ")";
}

/// @param rival  The other one of announced and pread.
void add_sentences(const WayRatio& rival, BestWay& best) {
  best.sentence =
      best.is_cold ? "Best on this disk: " : "Best, warm, which says nothing of the disk: ";
  const std::string announced = "announced pages of the mapping, as ptin reads by itself";
  if (best.verdict == Verdict::kFaster) {
    best.sentence += best.way == ReadWay::kPread ? "pread (--no-mmap)." : announced + ".";
  } else if (best.verdict == Verdict::kTie) {
    best.sentence += "a tie, within 10 %, of " + announced + ", and pread (--no-mmap).";
  } else {
    best.sentence += "not decided between " + announced + ", and pread (--no-mmap); ";
    best.sentence +=
        rival.depends_on_kind ? "it depends on the question." : "more --seconds may tell.";
  }
  std::string others;
  for (const WayRatio& other : best.others)
    others += (others.empty() ? "" : ", ") + told(other, best.kinds);
  best.beside = "Beside " + std::string(name_of(best.way)) + " " + others +
                (best.is_cold ? "; cold." : "; warm.");
}

}  // namespace

const char* name_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kFaster:
      return "faster";
    case Verdict::kTie:
      return "tie";
    default:
      return "undecided";
  }
}

Verdict WayRatio::verdict() const noexcept {
  const bool is_one_allowed = at_least <= 1 && at_most >= 1;
  const bool is_worth_telling = ratio >= kWorthTelling || ratio <= 1 / kWorthTelling;
  if (!is_one_allowed && is_worth_telling) return Verdict::kFaster;
  const bool is_within_tie = at_least >= 1 / kWidestTie && at_most <= kWidestTie;
  return is_within_tie && !depends_on_kind ? Verdict::kTie : Verdict::kUndecided;
}

std::optional<BestWay> best_way(const IoReport& report) {
  BestWay best;
  best.is_cold = report.why_not_cold.empty();
  std::vector<WayTimes> ways;
  for (const OpeningFigures& opening : report.opening) {
    if (best.is_cold || opening.way != ReadWay::kUring) ways.push_back({opening.way, {}});
  }
  for (const QuestionKind kind : kQuestionKinds) add_kind(report, kind, best.is_cold, ways);
  const auto times_of = [&](ReadWay way) -> const WayTimes& {
    return *std::find_if(ways.begin(), ways.end(), [&](const auto& w) { return w.way == way; });
  };
  if (ways.empty() || ways.front().kinds.empty()) return {};
  best.kinds = ways.front().kinds.size();
  const WayRatio pread = ratio_of(times_of(ReadWay::kPread), times_of(ReadWay::kAnnounced));
  best.verdict = pread.verdict();
  if (best.verdict == Verdict::kFaster && pread.ratio < 1) best.way = ReadWay::kPread;
  for (const WayTimes& way : ways) {
    if (way.way != best.way) best.others.push_back(ratio_of(way, times_of(best.way)));
  }
  add_sentences(pread, best);
  return best;
}

}  // namespace ptin::tools
