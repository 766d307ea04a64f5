// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/standard_output.h"

#include <cerrno>
#include <cstdio>

#include <stdio_ext.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin::tools {

namespace {

std::size_t bytes_to_stdout = 0;  ///< Bytes, by write_to_stdout().

[[noreturn]] void throw_lost(int reason) {
  std::clearerr(stdout);
  throw system_error(reason != 0 ? reason : EIO, "cannot write the answer", "standard output");
}

}  // namespace

void write_to_stdout(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) throw_lost(errno);
  bytes_to_stdout += text.size();
}

bool has_left_stdout() noexcept { return bytes_to_stdout > ::__fpending(stdout); }

void finish_stdout() {
  errno = 0;
  if (std::fflush(stdout) != 0) throw_lost(errno);
  if (std::ferror(stdout) == 0) return;
  // An earlier write failed, and its errno is gone. What is there is a part of the answer already,
  // so one byte more is written, which shows whether the disk is full.
  errno = 0;
  static_cast<void>(::write(STDOUT_FILENO, "\n", 1) == 1);
  throw_lost(errno);
}

}  // namespace ptin::tools
