// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/split_turns.h"

#include <algorithm>
#include <tuple>

namespace ptin {

namespace {

bool comes_before(const SplitTurn& a, const SplitTurn& b) noexcept {
  return std::tie(a.level, a.w, a.u) < std::tie(b.level, b.w, b.u);
}

}  // namespace

bool put_in_order(std::vector<SplitTurn>& turns) {
  constexpr std::uint32_t kNoPlace = UINT32_MAX;
  std::sort(turns.begin(), turns.end(), comes_before);
  std::vector<std::uint32_t> places(turns.size(), kNoPlace);  // by `at`
  for (auto level = turns.begin(); level != turns.end();) {
    const auto is_old = [&](const SplitTurn& t) {
      return t.level == level->level && t.w < SplitTurn::kMadeHere;
    };
    const auto first_new = std::partition_point(level, turns.end(), is_old);
    auto end = first_new;
    for (; end != turns.end() && end->level == level->level; ++end) {
      const std::uint32_t place = places[end->w - SplitTurn::kMadeHere];
      if (place == kNoPlace) return false;
      end->w = SplitTurn::kMadeHere + place;
    }
    std::sort(first_new, end, comes_before);
    for (; level != end; ++level) {
      places[level->at] = static_cast<std::uint32_t>(level - turns.begin());
    }
  }
  return true;
}

}  // namespace ptin
