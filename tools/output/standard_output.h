// SPDX-License-Identifier: GPL-3.0-or-later
//
// Standard output that says when it could not take what was written.
#pragma once

#include <cstddef>
#include <string_view>

namespace ptin::tools {

/// Writes to stdout; buffered.  @throws Error resource_exhausted (disk full), io_error
void write_to_stdout(std::string_view text);

/// Writes what is buffered, and looks whether anything before was lost.  @throws Error as above
void finish_stdout();

}  // namespace ptin::tools
