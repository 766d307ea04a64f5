// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plot of `ptin bench`.
#pragma once

#include <string>

#include "tools/measure/io_report.h"

namespace ptin::tools {

/// Draws how long questions take by each way, cold and warm, what threads bring, and what searches of
/// either index take.
/// @throws Error as Canvas and Canvas::publish
void plot_io(const std::string& path, bool overwrite, const IoRequest& request,
             const IoReport& report);

}  // namespace ptin::tools
