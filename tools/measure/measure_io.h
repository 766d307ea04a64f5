// SPDX-License-Identifier: GPL-3.0-or-later
//
// A benchmark of the input and output of one file on one disk: `ptin bench`.
#pragma once

#include "tools/measure/io_report.h"

namespace ptin::tools {

/// Measures how long questions take, cold and warm, by every way of reading; what threads bring; and
/// what searching the index costs. Never writes to the file; drops it from the page cache again and
/// again. Times are of the clock: a machine that does other things is slower.
///
/// Cold speaks of this system's page cache alone: what the disk, the host of a virtual machine or a
/// server keeps is not visible from here. A reading that was to be cold and was not is counted, and
/// is in no figure.
/// @throws Error not_found, io_error, corruption (also: the file was changed meanwhile), cancelled;
///               internal  an answer differs between two readings
[[nodiscard]] IoReport measure_io(const IoRequest& request);

}  // namespace ptin::tools
