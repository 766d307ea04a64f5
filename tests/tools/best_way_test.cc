// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which way of reading is told to be best: the sentence, JSON and all, follows from the ratios.
#include "tools/measure/best_way.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/ptin/bench_report.h"

namespace ptin::tools {
namespace {

/// Readings around a median: as many as asked, spread evenly in logarithms from the median over
/// `scatter` to the median times it.
Readings made_readings(double median, int times, double scatter) {
  Readings readings;
  for (int i = 0; i < times; ++i) {
    const double place = times == 1 ? 0.0 : 2.0 * i / (times - 1) - 1;
    readings.add({median * std::pow(scatter, place), {}, {}, 0});
  }
  return readings;
}

struct Made {
  std::vector<double> pread;  ///< Over announced, cold, of each kind.
  int times = 51;
  double scatter = 1.02;
  double faults = 2.0, uring = 1.0;  ///< Over announced, of every kind.
};

IoReport report_of(const Made& made) {
  IoReport report;
  for (const ReadWay way : kReadWays) report.opening.push_back({way, {}});
  for (std::size_t k = 0; k < made.pread.size(); ++k) {
    const double size = std::pow(10.0, static_cast<double>(k) - 3);
    const auto add = [&](ReadWay way, double cold, double warm) {
      QuestionFigures figures{kQuestionKinds[k], way, {}, {}, {}};
      figures.cold = made_readings(cold * size, made.times, made.scatter);
      if (way != ReadWay::kUring) figures.warm = made_readings(warm * size, made.times, 1.0);
      report.questions.push_back(figures);
    };
    add(ReadWay::kAnnounced, 1, 1);
    add(ReadWay::kFaults, made.faults, 0.5);
    add(ReadWay::kPread, made.pread[k], 2);
    add(ReadWay::kUring, made.uring, 0);
  }
  return report;
}

const WayRatio& ratio_of(const BestWay& best, ReadWay way) {
  return *std::find_if(best.others.begin(), best.others.end(),
                       [&](const WayRatio& r) { return r.way == way; });
}

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(BestWay, IsTheOneThatTakesLeastAndCanBeTaken) {
  const auto best = best_way(report_of({.pread = {0.8, 0.8}, .faults = 3.5, .uring = 0.5}));
  ASSERT_TRUE(best);
  EXPECT_EQ(best->verdict, Verdict::kFaster);
  EXPECT_EQ(best->way, ReadWay::kPread);
  EXPECT_EQ(best->kinds, 2U);
  EXPECT_TRUE(best->is_cold);
  EXPECT_EQ(best->sentence, "Best on this disk: pread (--no-mmap).");
  EXPECT_TRUE(has(best->beside, "announced takes 25 % longer (1.24 to 1.26 times, less in 0 of 2"))
      << best->beside;
  EXPECT_TRUE(has(best->beside, "io_uring would take 37 % less") ||
              has(best->beside, "io_uring would take 38 % less"))
      << best->beside;
  EXPECT_TRUE(has(best->beside, "announcements take 4.4 times as long")) << best->beside;
}

/// Few answers, at places that differ by a factor of ten: no kind decides by itself, but they agree.
TEST(BestWay, IsPreadWhereFiveOfSixKindsAreFasterByItHoweverFewTheAnswers) {
  const auto best = best_way(report_of(
      {.pread = {1 / 1.3, 1 / 1.7, 1 / 1.5, 1.03, 1 / 1.4, 1 / 1.6}, .times = 7, .scatter = 10}));
  ASSERT_TRUE(best);
  EXPECT_EQ(best->verdict, Verdict::kFaster) << best->beside;
  EXPECT_EQ(best->way, ReadWay::kPread);
  EXPECT_TRUE(has(best->sentence, "pread (--no-mmap)."));
  EXPECT_TRUE(has(best->beside, "less in 1 of 6 kinds")) << best->beside;
  const WayRatio& announced = ratio_of(*best, ReadWay::kAnnounced);
  EXPECT_GT(announced.at_least, 1);
  EXPECT_NEAR(announced.ratio, std::pow(1.3 * 1.7 * 1.5 / 1.03 * 1.4 * 1.6, 1 / 6.0), 1e-9);
}

TEST(BestWay, IsATieWhereAllThatTheReadingsAllowIsWithinTenPercent) {
  const auto best = best_way(report_of({.pread = {1.01, 0.98, 1.0, 1.02, 0.99, 0.97}}));
  ASSERT_TRUE(best);
  EXPECT_EQ(best->verdict, Verdict::kTie);
  EXPECT_TRUE(has(best->sentence, "a tie, within 10 %")) << best->sentence;
  EXPECT_TRUE(has(best->beside, "(a tie: ")) << best->beside;
  EXPECT_EQ(ratio_of(*best, ReadWay::kFaults).verdict(), Verdict::kFaster);
  // A difference that is sure, and not worth telling.
  EXPECT_EQ(best_way(report_of({.pread = {0.97, 0.97}}))->verdict, Verdict::kTie);
}

TEST(BestWay, OfFewScatteredAnswersIsNotDecidedAndNoTie) {
  const auto best = best_way(report_of({.pread = {0.9, 0.9}, .times = 3, .scatter = 5}));
  ASSERT_TRUE(best);
  EXPECT_EQ(best->verdict, Verdict::kUndecided);
  EXPECT_TRUE(has(best->sentence, "not decided")) << best->sentence;
  EXPECT_TRUE(has(best->sentence, "--seconds")) << best->sentence;
  EXPECT_TRUE(has(best->beside, "pread takes 10 % less (not decided: ")) << best->beside;
  // Two kinds that agree by chance say less than their scatter.
  EXPECT_EQ(best_way(report_of({.pread = {0.7, 0.7}, .times = 1}))->verdict, Verdict::kUndecided);
}

TEST(BestWay, DependsOnTheQuestionWhereKindsAreSureAndContradictEachOther) {
  for (const std::vector<double>& pread :
       {std::vector<double>{0.5, 0.5, 0.5, 2, 2, 2}, {0.5, 2.1}}) {
    const auto best = best_way(report_of({.pread = pread, .scatter = 1.3}));
    ASSERT_TRUE(best);
    EXPECT_EQ(best->verdict, Verdict::kUndecided) << best->beside;
    EXPECT_TRUE(has(best->sentence, "it depends on the question")) << best->sentence;
  }
}

TEST(BestWay, IsOfWarmFiguresWhereThereAreNoColdOnes) {
  IoReport report = report_of({.pread = {0.5, 0.5}});
  report.why_not_cold = "it lies in memory";
  const auto best = best_way(report);
  EXPECT_EQ(best->way, ReadWay::kAnnounced);
  EXPECT_EQ(best->verdict, Verdict::kFaster);
  EXPECT_FALSE(best->is_cold);
  EXPECT_EQ(best->others.size(), 2U);
  EXPECT_TRUE(has(best->sentence, "says nothing of the disk"));
}

TEST(BestWay, CountsKindsThatEveryWayAnswered) {
  IoReport report = report_of({.pread = {1.0, 1.0}});
  report.questions.back().cold = {};
  EXPECT_EQ(best_way(report)->kinds, 1U);
  for (QuestionFigures& f : report.questions) f.cold = {};
  EXPECT_FALSE(best_way(report));
}

TEST(BestWay, IsTheSameInJson) {
  const nlohmann::json won = json_of({}, report_of({.pread = {0.8, 0.8}}))["best"];
  EXPECT_EQ(won["by"], "pread");
  EXPECT_EQ(won["over"], "pread");
  EXPECT_EQ(won["verdict"], "faster");
  EXPECT_EQ(won["others"].size(), 3U);
  EXPECT_EQ(won["others"][0]["by"], "announced");
  EXPECT_NEAR(won["others"][0]["ratio"].get<double>(), 1.25, 1e-9);
  const nlohmann::json open =
      json_of({}, report_of({.pread = {0.9}, .times = 3, .scatter = 5}))["best"];
  EXPECT_EQ(open["by"], nullptr);
  EXPECT_EQ(open["over"], "announced");
  EXPECT_EQ(open["verdict"], "undecided");
}

}  // namespace
}  // namespace ptin::tools
