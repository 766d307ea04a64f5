// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/isolines.h"

namespace ptin::ask {

void add_isolines(Parameters& rows, IsolineQuestion& question) {
  IsolineRequest& request = question.request;
  add_levels(rows, question.levels, "Heights of the lines, instead of an interval",
             "Every multiple of D, from the base", Door::kBoth);
  add_region(rows, question.region, RegionKinds::kWithInside, Door::kBoth);
  add_detail(rows, request.detail, "",
             "The isolines of the TIN of the terrain's N most important vertices, instead of an "
             "error");
  rows.add("max-lines", &request.most_lines, "N",
           "Refuse, before anything is written, when there are more lines, or "
           "polygons")
      .with_default()
      .at(Door::kProgram);
}

}  // namespace ptin::ask
