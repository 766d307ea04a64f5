// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/best_way.h"

#include <algorithm>
#include <cmath>

#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr double kWorthTelling = 0.05;  // of a logarithm: about 5 %

/// The logarithms of what one way takes: of the medians, added over the kinds, and the square of the
/// error that this sum has since only so many places were asked.
struct WaySum {
  ReadWay way;
  double log_sum = 0.0;
  double error_square = 0.0;
};

/// The logarithm of the median of a row, and the square of its error; none where there is no reading.
std::optional<WaySum> log_of_median(const QuestionFigures& figures, bool cold) {
  const Readings& readings = cold ? figures.cold : figures.warm;
  const auto median = readings.seconds().median;
  if (!median) return {};
  const auto log_of = [](double seconds) { return std::log(std::max(seconds, 1e-9)); };
  const auto n = static_cast<double>(readings.all().size());
  double sum = 0.0;
  double squares = 0.0;
  for (const Reading& r : readings.all()) {
    sum += log_of(r.seconds);
    squares += log_of(r.seconds) * log_of(r.seconds);
  }
  // Of one or two places nobody knows how far others are from them: by a factor of e, say.
  const double spread = n < 3 ? 1.0 : std::max(0.0, squares - sum * sum / n) / (n - 1);
  constexpr double kMedianOverMean = 1.5708;  // of the squares of their errors, of normal values
  return WaySum{figures.way, log_of(*median), kMedianOverMean * spread / n};
}

/// Adds the medians of a kind, if each way has one.
bool add_kind(const IoReport& report, QuestionKind kind, bool cold, std::vector<WaySum>& sums) {
  std::vector<WaySum> added;
  for (const WaySum& sum : sums) {
    const auto row =
        std::find_if(report.questions.begin(), report.questions.end(),
                     [&](const QuestionFigures& f) { return f.kind == kind && f.way == sum.way; });
    const auto of_row = row == report.questions.end() ? std::nullopt : log_of_median(*row, cold);
    if (!of_row) return false;
    added.push_back(*of_row);
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i].log_sum += added[i].log_sum;
    sums[i].error_square += added[i].error_square;
  }
  return true;
}

/// How much longer one way takes than another: the logarithm of the ratio, 0 where what was asked
/// does not tell them apart.
double log_over(const WaySum& way, const WaySum& other, std::size_t kinds) {
  const auto n = static_cast<double>(kinds);
  const double log = (way.log_sum - other.log_sum) / n;
  const double error = std::sqrt(way.error_square + other.error_square) / n;
  return std::abs(log) < std::max(kWorthTelling, 2 * error) ? 0.0 : log;
}

/// "as long", "35 % longer", "20 % less", "3.5 times as long".
std::string compared(double ratio) {
  if (ratio == 1) return "as long";
  if (ratio >= 2) return short_number(std::round(10 * ratio) / 10) + " times as long";
  return std::to_string(std::lround(std::abs(ratio - 1) * 100)) + " % " +
         (ratio > 1 ? "longer" : "less");
}

void add_sentences(BestWay& best) {
  best.sentence =
      best.is_cold ? "Best on this disk: " : "Best, warm, which says nothing of the disk: ";
  best.sentence += best.way == ReadWay::kPread
                       ? "pread (--no-mmap)."
                       : "announced pages of the mapping, as ptin reads by itself.";
  std::string others;
  for (const auto& [way, ratio] : best.over_best) {
    if (way == best.way) continue;
    others += others.empty() ? "" : ", ";
    others += way == ReadWay::kFaults ? "faults without announcements" : name_of(way);
    others +=
        way == ReadWay::kUring ? " would take " : (way == ReadWay::kFaults ? " take " : " takes ");
    others += compared(ratio);
  }
  best.beside = "Beside it " + others + (best.is_cold ? " (cold, " : " (warm, ") +
                counted(best.kinds, "kind") + " of questions).";
}

}  // namespace

std::optional<BestWay> best_way(const IoReport& report) {
  BestWay best;
  best.is_cold = report.why_not_cold.empty();
  std::vector<WaySum> sums;
  for (const OpeningFigures& opening : report.opening) {
    if (best.is_cold || opening.way != ReadWay::kUring) sums.push_back({opening.way});
  }
  for (const QuestionKind kind : kQuestionKinds) {
    if (add_kind(report, kind, best.is_cold, sums)) ++best.kinds;
  }
  if (best.kinds == 0) return {};
  const auto sum_of = [&](ReadWay way) {
    return *std::find_if(sums.begin(), sums.end(), [&](const WaySum& s) { return s.way == way; });
  };
  const double pread = log_over(sum_of(ReadWay::kPread), sum_of(ReadWay::kAnnounced), best.kinds);
  best.way = pread < 0 ? ReadWay::kPread : ReadWay::kAnnounced;
  for (const WaySum& sum : sums) {
    best.over_best.emplace_back(sum.way, std::exp(log_over(sum, sum_of(best.way), best.kinds)));
  }
  add_sentences(best);
  return best;
}

}  // namespace ptin::tools
