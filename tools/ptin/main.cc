// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program `ptin`: signals in, exit status out; everything else is in the subcommands.
#include "tools/ptin/cli.h"
#include "tools/ptin/stop_on_signals.h"
#include "tools/refused_memory.h"

int main(int argc, char** argv) {
  ptin::tools::Context context;
  ptin::tools::prepare_for_refused_memory();
  try {
    context.stop = ptin::tools::stop_on_signals();
  } catch (...) {
    return ptin::tools::report_current_error(context.json);
  }
  return ptin::tools::run_program(argc, argv, context);
}
