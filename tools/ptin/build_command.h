// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build is asked on the command line.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/construct/build.h"

namespace ptin::tools {

struct BuildCommand {
  std::vector<std::string> inputs;
  std::string output;
  BuildOptions options;
  bool overwrite = false;
  std::string memory, tmp;
  int threads = 0;
  bool resume = false, discard = false, dry_run = false;
  int progress_fd = -1;
  int parts = 0;     ///< 0: it is one job.
  std::string plan;  ///< With `parts`: the file for those who do them.
};

/// Declares the options of `ptin build`.
void declare_build_options(CLI::App& app, BuildCommand& command);

}  // namespace ptin::tools
