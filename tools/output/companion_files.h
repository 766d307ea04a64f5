// SPDX-License-Identifier: GPL-3.0-or-later
//
// Companions: files that programs read along with another one, such as a GeoPackage's journal, a
// shapefile's index or a raster's overviews. Beside a file that was replaced they belong to the
// file that is gone.
#pragma once

#include <string>
#include <vector>

namespace ptin::tools {

/// The names that companions of `path` would have, by its extension, whether they are there or not:
/// those that GDAL and SQLite look for and would believe. Files that GDAL writes anew with `path`
/// itself are not among them.
[[nodiscard]] std::vector<std::string> companions_of(const std::string& path);

/// Removes the companions of `path` that are there.  @throws Error io_error  one cannot be removed
void remove_companions(const std::string& path);

}  // namespace ptin::tools
