// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which files an input is made of, and whether they are still the same.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// The files that are read when `input` is: itself, the sources of a VRT (of VRTs in it, too), and
/// what GDAL reads beside them (.aux.xml, world files, masks, the parts of a shapefile). Sorted.
/// Inputs that are no files give themselves. Cost: opens the input, and each source of a VRT.
[[nodiscard]] std::vector<std::string> files_of_input(const std::string& input);

/// The inputs, each folder that holds LAS or LAZ files replaced by these, in the order of their
/// names; folders in it are not looked into. Other folders are left to GDAL, which reads some.
/// @throws Error invalid_argument  an input is standard input; io_error  a folder cannot be read
[[nodiscard]] std::vector<std::string> with_folders_opened(const std::vector<std::string>& inputs);

/// Warns of a file that is named more than once, links resolved.
void warn_of_repeated(const std::vector<std::string>& inputs, SourceWarnings& warnings);

/// Names, sizes and times of change of all files of all inputs: another value means that an input
/// has changed, or that one of its files was added or removed.
[[nodiscard]] nlohmann::json input_fingerprint(const std::vector<std::string>& inputs);

/// The bytes of all files in a fingerprint, each counted once; 0 where no system gives them.
[[nodiscard]] std::uint64_t bytes_in(const nlohmann::json& input_fingerprint);

}  // namespace ptin
