// SPDX-License-Identifier: GPL-3.0-or-later
//
// The front program: `ptin` without GDAL, PROJ and libcurl. In the place of their functions it has
// stand-ins, each of which begins the command line again in the whole program.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include <unistd.h>

#include "engine/error.h"
#include "tools/error_status.h"
#include "tools/output/standard_output.h"
#include "tools/output/temporary_path.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/front.h"
#include "tools/ptin/stop_on_signals.h"

namespace {

char** words = nullptr;
ptin::tools::Context context;

[[noreturn]] void end(const ptin::Error& error) {
  ptin::tools::report_error(error, context.json);
  std::_Exit(ptin::tools::status_of(error.code()).exit);
}

/// The path of the whole program, by where this one lies: both are installed together. Never a path
/// from the current folder, where anybody may have put a program.
std::string path_of_whole_program() {
  std::error_code fault;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", fault);
  if (fault) {
    end({ptin::ErrorCode::not_found,
         "this work needs GDAL, and the program that has it lies beside this one, whose place the "
         "system does not tell (" +
             fault.message() + "); mount /proc, or start ptin-whole itself",
         "/proc/self/exe"});
  }
  return (here.parent_path() / PTIN_WHOLE_PROGRAM).lexically_normal().string();
}

}  // namespace

/// Becomes the whole program, with the words of this one. What stand-ins call.
extern "C" [[noreturn]] void ptin_hand_over() noexcept {
  ptin::tools::remove_temporary_paths();
  if (context.stop.stop_requested()) end({ptin::ErrorCode::cancelled, "stopped by a signal"});
  if (ptin::tools::has_left_stdout()) {  // The whole program would write it once more.
    end({ptin::ErrorCode::io_error,
         "a part of the answer was written when GDAL was needed; write to a file with -o, or start "
         "ptin-whole itself",
         "standard output"});
  }
  const std::string path = path_of_whole_program();
  ::execv(path.c_str(), words);
  end({ptin::ErrorCode::not_found,
       "this work needs GDAL, and the program of this version that has it cannot be started; "
       "install ptin whole (" +
           std::system_category().message(errno) + ")",
       path});
}

int main(int argc, char** argv) {
  words = argv;
  return ptin::tools::run_program(
      argc, argv, context, [](const ptin::tools::Command& command, ptin::tools::Context& of) {
        if (!ptin::tools::is_for_front(command, *of.reading)) ptin_hand_over();
        of.stop = ptin::tools::stop_on_signals();
      });
}
