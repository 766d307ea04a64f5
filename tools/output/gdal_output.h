// SPDX-License-Identifier: GPL-3.0-or-later
//
// What GDAL says when it cannot write, as Errors; and GDAL's drivers.
#pragma once

#include <string>

#include <cpl_error.h>

#include "engine/error.h"

class GDALDriver;

namespace ptin::tools {

/// The error for a call of GDAL that failed, with GDAL's last message: resource_exhausted when the
/// disk of `path` is full, else io_error.
/// @param was_disk_full  What is_disk_full() said before GDAL removed its files, where it was
///                       asked.
[[nodiscard]] Error gdal_failure(const std::string& action, const std::string& path,
                                 bool was_disk_full = false);

/// True when the disk of `path` has less than a mebibyte of room. To be asked before GDAL tidies up
/// after a failure.
[[nodiscard]] bool is_disk_full(const std::string& path);

/// Throws unless `result` is CE_None.
/// @throws Error as gdal_failure()
void require_done(CPLErr result, const std::string& action, const std::string& path);

/// A driver of GDAL's.  @throws Error io_error  this GDAL was built without it
[[nodiscard]] GDALDriver& driver_named(const char* name);

}  // namespace ptin::tools
