// SPDX-License-Identifier: GPL-3.0-or-later
//
// An output never takes the place of what it is made from.
#pragma once

#include <span>
#include <string>

namespace ptin {

/// Compares an output, if it is there, with files by device and inode, so through links too; "-" is standard
/// input, and the files behind a VRT are compared as well. What names no file is passed over.
/// @throws Error invalid_argument  the output is one of these files
/// Cost: a look at each file, where the output is there.
void check_inputs_are_kept(std::span<const std::string> inputs, const std::string& output);

}  // namespace ptin
