// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions about files, asked by name. std::filesystem answers them; what the system refuses to
// say is an Error.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ptin {

/// The folder of the file that `path` names; "." for a bare name.
[[nodiscard]] std::string folder_of(const std::string& path);

/// False when there is nothing of this name.
/// @throws Error io_error  the system does not say: a name too long, links in a circle, no right to
///                         look
[[nodiscard]] bool is_there(const std::string& path);

/// Reads the first byte of a file, so that a file that cannot be read is not taken for one of no
/// known format. Does nothing where `path` is no file of the system's: a folder, an archive, a
/// server.
/// @throws Error io_error  the system refuses to open or to read it
void require_readable(const std::string& path);

/// The length of a file. @throws Error not_found, io_error (also: it is a folder)
[[nodiscard]] std::uint64_t bytes_of_file(const std::string& path);

/// The paths of all files and folders in a folder, in no order. @throws Error not_found, io_error
[[nodiscard]] std::vector<std::string> paths_in(const std::string& folder);

/// The path of a file from the root. @throws Error not_found  the working folder is gone; io_error
[[nodiscard]] std::string absolute_path(const std::string& path);

/// Where the system keeps temporary files. @throws Error not_found, io_error
[[nodiscard]] std::string system_temporary_folder();

}  // namespace ptin
