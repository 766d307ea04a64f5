// SPDX-License-Identifier: GPL-3.0-or-later
//
// What several threads bring: small questions, many of them, on one opened file.
#pragma once

#include "tools/measure/io_report.h"
#include "tools/measure/io_run.h"

namespace ptin::tools {

/// Fills `threads` of a report, for about `seconds`: points and windows of 1/10 000 by every way on
/// 1, 2, 4 ... threads. A cold run drops the file, opens it, and lets the threads take so many
/// questions, each at a place of its own; the warm run asks the same ones again, several times
/// where they take no time.
/// REQUIRES: run_questions() filled `questions`: a kind that it left out is left out here.
/// @throws Error corruption  the file was changed; cancelled, io_error
void run_threads(IoRun& run, double seconds, IoReport& report);

}  // namespace ptin::tools
