// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/standard_output.h"

#include <cerrno>
#include <cstdio>

#include "engine/error.h"

namespace ptin::tools {

namespace {

[[noreturn]] void throw_lost(int reason) {
  std::clearerr(stdout);
  throw system_error(reason != 0 ? reason : EIO, "cannot write the answer", "standard output");
}

}  // namespace

void write_to_stdout(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) throw_lost(errno);
}

void finish_stdout() {
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw_lost(errno);
}

}  // namespace ptin::tools
