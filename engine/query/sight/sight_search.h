// SPDX-License-Identifier: GPL-3.0-or-later
//
// The search for what one line of sight needs to know. Two ways to search differ in what they read
// next: sight_stars.h, and paper/visibility.h.
#pragma once

#include "engine/query/sight/sight_line.h"

namespace ptin {

/// One line of sight that is being answered. Threads: one owner.
class SightSearch {
 public:
  SightSearch(const SightSearch&) = delete;
  SightSearch& operator=(const SightSearch&) = delete;
  virtual ~SightSearch() = default;

  /// What is known of the line so far.
  [[nodiscard]] virtual const SightLine& line() const noexcept = 0;
  /// Makes the ground below the ends exact, unless the budget is spent.
  void finish_ends() {
    if (!ends_known() && !out_of_budget()) {
      find_ends();
    }
  }
  /// Finds what is asked of the line beside the verdict, until the budget is spent.
  virtual void finish_line() = 0;
  /// The verdict, as far as level of detail and budget let it be known.
  /// REQUIRES: finish_line() came before, unless the verdict alone is asked for.
  [[nodiscard]] virtual SightVerdict decide() = 0;

  /// True when all that is asked of the ends is known. Absolute ends are asked for their states
  /// alone, and only voids can change a state.
  [[nodiscard]] bool ends_known() const noexcept {
    return (line().a.known && line().b.known) || (request_.absolute && !facts_.has_voids);
  }

 protected:
  /// All borrowed for the life of the search.
  SightSearch(const SightFacts& facts, const SightRequest& request, QueryContext& context)
      : facts_(facts), request_(request), context_(context) {}

  virtual void find_ends() = 0;
  /// True when as many stars, records or samples were read as the request allows.
  [[nodiscard]] bool out_of_budget() const noexcept {
    return request_.budget && context_.cost.stars_read + context_.cost.samples_read +
                                      context_.cost.records_retrieved >=
                                  *request_.budget;
  }

  const SightFacts& facts_;
  const SightRequest& request_;
  QueryContext& context_;
};

}  // namespace ptin
