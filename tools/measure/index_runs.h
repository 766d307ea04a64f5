// SPDX-License-Identifier: GPL-3.0-or-later
//
// The packed R-tree beside libspatialindex's: searches alone, cold and warm.
#pragma once

#include "tools/measure/io_report.h"
#include "tools/measure/io_run.h"

namespace ptin::tools {

/// Fills `index` of a report, for about `seconds`: which pages hold the records of points and
/// windows, found by either index, and not read. The second index is built first, in a folder of
/// its own that goes with the call; it is left out where sorting the pages' boxes takes more than
/// the request's memory. Cold: the file and the second index are dropped and opened again; opening
/// is not measured.
/// @throws Error corruption  the file was changed; cancelled, io_error; internal  the two find
///                           different pages
void run_indexes(IoRun& run, double seconds, IoReport& report);

}  // namespace ptin::tools
