// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file's name says, and what the system says of the file.
#pragma once

#include <cstdint>
#include <string>

namespace ptin::tools {

/// Letters A to Z made small.
[[nodiscard]] std::string lower_case(std::string text);
/// ".tif" of "A/V.TIF"; empty when there is none.
[[nodiscard]] std::string lower_extension(const std::string& path);

/// True when a file or folder has this name.
/// @throws Error io_error  the system does not tell: a name too long, links in a circle, no right
///                         to look
[[nodiscard]] bool is_there(const std::string& path);
/// Size of a file in bytes.  @throws Error not_found, io_error
[[nodiscard]] std::uint64_t file_bytes(const std::string& path);

}  // namespace ptin::tools
