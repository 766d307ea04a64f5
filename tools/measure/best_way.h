// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a report comes to: which way of reading is best.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/measure/io_report.h"

namespace ptin::tools {

/// The verdict of the readings on two ways.
enum class Verdict : std::uint8_t {
  kFaster,     ///< One takes less, by 5 % or more: 1 is no ratio that the readings allow.
  kTie,        ///< All ratios that they allow are within 10 % of 1, and no kinds contradict it.
  kUndecided,  ///< Neither: too few answers, or kinds of questions that contradict each other.
};

/// "faster", "tie", "undecided".
[[nodiscard]] const char* name_of(Verdict verdict) noexcept;

/// The time of a way over that of another one: of each kind of question the ratio of the medians, of
/// these the geometric mean.
struct WayRatio {
  ReadWay way = ReadWay::kAnnounced;
  double ratio = 1.0;
  double at_least = 1.0, at_most = 1.0;  ///< The ratios that the readings allow, with 95 %.
  std::size_t kinds_less = 0;            ///< Kinds of which it takes less, however little.
  /// Some kinds, each by itself, are clearly faster by this way, and others by the other one.
  bool depends_on_kind = false;

  [[nodiscard]] Verdict verdict() const noexcept;
};

/// Which of the ways that `ptin` can take (announced, pread) takes least.
///
/// Kinds are compared in pairs, since a window takes a thousand times what a point takes. The error
/// of the mean is the smaller of two estimates: how far the kinds' ratios lie from each other, which
/// needs three kinds, and how far the places of each kind do.
struct BestWay {
  Verdict verdict = Verdict::kUndecided;
  /// The faster one; where there is none announced, which `ptin` takes by itself.
  ReadWay way = ReadWay::kAnnounced;
  bool is_cold = false;   ///< Cold medians decided; else warm ones, where there are no cold ones.
  std::size_t kinds = 0;  ///< Kinds of questions that decided: those that all ways answered.
  std::vector<WayRatio> others;  ///< Each other way that was measured, over `way`.
  std::string sentence;          ///< Which is best here, or that none is known to be.
  std::string beside;            ///< The others beside it; a sentence, too.
};

/// None where no kind of question was answered by every way.
[[nodiscard]] std::optional<BestWay> best_way(const IoReport& report);

}  // namespace ptin::tools
