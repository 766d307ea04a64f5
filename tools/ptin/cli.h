// SPDX-License-Identifier: GPL-3.0-or-later
//
// The command line: parsing, help, and errors as text or JSON.
#pragma once

#include <functional>

#include "engine/error.h"
#include "tools/ptin/command.h"

namespace ptin::tools {

/// Every exit status in one sentence.
[[nodiscard]] const char* exit_statuses() noexcept;

/// Work between parsing and the subcommand; none where help or a fault ends the work.
using BeforeWork = std::function<void(const Command& command, Context& context)>;

/// Lets GDAL's drivers be known, and GDAL and PROJ be silent: what GDAL says travels in our own
/// errors, and not to stderr.
void start_gdal(const Command& command, Context& context);

/// Parses the command line and runs its subcommand. --help and --version return 0; wrong use writes
/// a sentence to stderr and returns 2.
/// @throws Error  what the subcommand throws
int run_command_line(int argc, const char* const* argv, Context& context, const BeforeWork& before);

/// Reports the exception being handled; returns its exit status. Without memory for that it ends
/// the process as tools/refused_memory.h says. REQUIRES: called inside a catch block.
int report_current_error(bool json) noexcept;

/// The whole program but for its signals: runs the command line, and reports what it throws.
/// @returns the exit status
int run_program(int argc, const char* const* argv, Context& context,
                const BeforeWork& before = start_gdal);

/// Writes an error to stderr: `ptin: context: message`, or {"error": {"code", "message",
/// "context"}}.
void report_error(const Error& error, bool json);

}  // namespace ptin::tools
