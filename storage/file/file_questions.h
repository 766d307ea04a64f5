// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is asked about files by their names: as std::filesystem answers, but that the system's
// refusals are Errors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ptin {

/// The folder that a path names a file in: "." for a bare name.
[[nodiscard]] std::string folder_of(const std::string& path);

/// False when there is nothing of this name.
/// @throws Error io_error  the system does not say: a name too long, links in a circle, no right to
///                         look
[[nodiscard]] bool is_there(const std::string& path);

/// @throws Error not_found, io_error (a folder, too)
[[nodiscard]] std::uint64_t bytes_of_file(const std::string& path);

/// The paths of what a folder holds. @throws Error not_found, io_error
[[nodiscard]] std::vector<std::string> paths_in(const std::string& folder);

/// The path from the root. @throws Error not_found  the working folder is gone; io_error
[[nodiscard]] std::string absolute_path(const std::string& path);

/// Where the system keeps temporary files. @throws Error not_found, io_error
[[nodiscard]] std::string system_temporary_folder();

}  // namespace ptin
