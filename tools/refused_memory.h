// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program does when the system refuses memory: it ends with status 7 and one sentence,
// wherever that happens.
#pragma once

#include <string>

#include "engine/error.h"

namespace ptin::tools {

/// Prepares for it, until the process ends:
/// - A reserve is given back when memory is first refused, so that there is some for the error's
///   sentence, for destructors, and for libraries that must close their files.
/// - What is thrown where nothing may be thrown (a destructor of GDAL's or of nlohmann's that
///   allocates) does not abort the process: temporary files are removed, the sentence is written,
///   and the status is 7. So it is where a library aborts the process after that (GDAL's and PROJ's
///   do). Other exceptions and aborts end it as before.
void prepare_for_refused_memory();

/// Whether the sentence is written as JSON then; at first it is not.
void tell_refused_memory_as_json(bool as_json) noexcept;

/// @throws Error resource_exhausted  memory_was_refused(): a library that caught that may have left
///                                   something out of the file that it wrote
void require_memory_given(const std::string& path);

/// True when operator new was refused memory since prepare_for_refused_memory(). Libraries that
/// catch that speak of something else: a feature that is too big, a file that cannot be opened.
[[nodiscard]] bool memory_was_refused() noexcept;

/// The one sentence.
[[nodiscard]] const char* refused_memory_sentence() noexcept;

}  // namespace ptin::tools
