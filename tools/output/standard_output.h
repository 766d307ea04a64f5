// SPDX-License-Identifier: GPL-3.0-or-later
//
// Standard output, with an Error when something could not be written.
#pragma once

#include <cstddef>
#include <string_view>

namespace ptin::tools {

/// Writes to stdout; buffered.  @throws Error resource_exhausted (disk full), io_error
void write_to_stdout(std::string_view text);

/// Whether some of it has left the buffer, and cannot be taken back.
[[nodiscard]] bool has_left_stdout() noexcept;

/// Writes what is buffered.  @throws Error as above, also when an earlier write to stdout was lost
void finish_stdout();

}  // namespace ptin::tools
