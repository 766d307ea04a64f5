// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that programs read along with one of another name: a GeoPackage's journal, a shapefile's
// index, a raster's overviews. Beside a file that was replaced they speak of what is gone.
#pragma once

#include <string>
#include <vector>

namespace ptin::tools {

/// The names that companions of `path` have, whether they are there or not, by its extension: what
/// GDAL and SQLite look for and would believe. None that GDAL writes anew with the file itself.
[[nodiscard]] std::vector<std::string> companions_of(const std::string& path);

/// Removes those that are there.  @throws Error io_error  one cannot be removed
void remove_companions(const std::string& path);

}  // namespace ptin::tools
