// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/highest.h"

#include <cstdint>
#include <limits>

namespace ptin::ask {

void add_highest(Parameters& rows, HighestQuestion& question) {
  HighestRequest& request = question.request;
  add_region(rows, question.region, RegionKinds::kWithInside, Door::kBoth);
  rows.add("lowest", &request.lowest, "", "The lowest point instead").like("true");
  rows.add("listed", &request.listed, "K", "How many of the highest vertices to list")
      .spelled("-k")
      .within({.least = 1, .most = 1e6})
      // The service has a limit of its own.
      .within_over_http({.least = 1, .most = std::numeric_limits<std::uint32_t>::max()})
      .with_default()
      .like("10");
  add_detail(rows, request.detail, "; the height comes with an interval",
             "The highest of the TIN of the terrain's N most important vertices, instead of an "
             "error; its height comes with an interval");
}

}  // namespace ptin::ask
