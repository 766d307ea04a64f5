// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file's name says.
#pragma once

#include <string>

namespace ptin::tools {

/// Letters A to Z made small.
[[nodiscard]] std::string lower_case(std::string text);
/// ".tif" of "A/V.TIF"; empty when there is none.
[[nodiscard]] std::string lower_extension(const std::string& path);

}  // namespace ptin::tools
