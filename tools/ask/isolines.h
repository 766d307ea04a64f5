// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of isolines: `ptin isoline`, and `isolines` over HTTP.
#pragma once

#include "tools/ask/groups.h"

namespace ptin::ask {

struct IsolineQuestion {
  IsolineRequest request;
  Levels levels;
  RegionText region;
};
void add_isolines(Parameters& rows, IsolineQuestion& question);

}  // namespace ptin::ask
