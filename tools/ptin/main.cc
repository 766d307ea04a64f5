// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program `ptin`: signals in, exit status out; everything else is in the subcommands.
#include "tools/error_status.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/stop_on_signals.h"

int main(int argc, char** argv) {
  ptin::tools::Context context;
  try {
    context.stop = ptin::tools::stop_on_signals();
  } catch (...) {
    const ptin::Error error = ptin::tools::current_error();
    ptin::tools::report_error(error, context.json);
    return ptin::tools::status_of(error.code()).exit;
  }
  return ptin::tools::run_program(argc, argv, context);
}
