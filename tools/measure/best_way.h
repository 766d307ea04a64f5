// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a report comes to: which way of reading is best.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/measure/io_report.h"

namespace ptin::tools {

/// Of the ways that `ptin` can take (announced, pread), the one whose questions take least.
struct BestWay {
  ReadWay way = ReadWay::kAnnounced;
  bool is_cold = false;   ///< Cold medians decided; else warm ones, where there are no cold ones.
  std::size_t kinds = 0;  ///< Kinds of questions that decided: those that all ways answered.
  /// Of each way that was measured: its time over that of the best, the geometric mean over the
  /// kinds; 1 where they differ by less than 5 %, or than twice the error that comes of asking at so
  /// many places.
  std::vector<std::pair<ReadWay, double>> over_best;
  std::string sentence;  ///< Which is best here.
  std::string beside;    ///< The others beside it; a sentence, too.
};

/// Where nothing tells them apart, the way that `ptin` takes by itself is best.
/// None where no kind of question was answered by every way.
[[nodiscard]] std::optional<BestWay> best_way(const IoReport& report);

}  // namespace ptin::tools
