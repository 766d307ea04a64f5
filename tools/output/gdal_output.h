// SPDX-License-Identifier: GPL-3.0-or-later
//
// What GDAL says when it cannot write, as our own errors; and its drivers.
#pragma once

#include <string>

#include <cpl_error.h>

#include "engine/error.h"

class GDALDriver;

namespace ptin::tools {

/// The error for a call of GDAL that failed: resource_exhausted when the disk of `path` is full,
/// else io_error. Takes GDAL's last message.
/// @param was_disk_full  What is_disk_full() said earlier.
[[nodiscard]] Error gdal_failure(const std::string& action, const std::string& path,
                                 bool was_disk_full = false);

/// True when the disk of `path` has next to no room. Asked before GDAL tidies up after a failure.
[[nodiscard]] bool is_disk_full(const std::string& path);

/// @throws Error as gdal_failure()  when GDAL refused what `action` says
void require_done(CPLErr result, const std::string& action, const std::string& path);

/// A driver of GDAL's.  @throws Error io_error  this GDAL was built without it
[[nodiscard]] GDALDriver& driver_named(const char* name);

}  // namespace ptin::tools
