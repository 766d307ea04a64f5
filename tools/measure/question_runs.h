// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every kind of question by every way, cold and warm.
#pragma once

#include "tools/measure/io_report.h"
#include "tools/measure/io_run.h"

namespace ptin::tools {

/// Fills `opening` and `questions` of a report, for about `seconds`. A round of a kind asks one
/// question by each way, each at a place of its own: no way finds a place in a cache below the
/// system's because another way has asked there. The kind that has had the least time is next.
///
/// A cold reading: the file is dropped, seen to be gone, opened and asked once. The warm reading asks
/// the same once more. Of io_uring, which a warm question does not use, there is none.
/// @throws Error corruption  the file was changed; cancelled, io_error
void run_questions(IoRun& run, double seconds, IoReport& report);

}  // namespace ptin::tools
