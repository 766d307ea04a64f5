// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of the highest or lowest point: `ptin highest`, and `highest` over HTTP.
#pragma once

#include "tools/ask/groups.h"

namespace ptin::ask {

struct HighestQuestion {
  HighestRequest request;
  RegionText region;
};
void add_highest(Parameters& rows, HighestQuestion& question);

}  // namespace ptin::ask
