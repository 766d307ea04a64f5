// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program `ptin`: signals in, exit status out; everything else is in the subcommands.
#include <cpl_error.h>
#include <gdal.h>

#include "tools/error_status.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/stop_on_signals.h"

int main(int argc, char** argv) {
  ptin::tools::Context context;
  try {
    context.stop = ptin::tools::stop_on_signals();
    CPLSetErrorHandler(CPLQuietErrorHandler);  // what GDAL says travels in our own errors
    GDALAllRegister();
    return ptin::tools::run_command_line(argc, argv, context);
  } catch (...) {
    const ptin::Error error = ptin::tools::current_error();
    ptin::tools::report_error(error, context.json);
    return ptin::tools::status_of(error.code()).exit;
  }
}
