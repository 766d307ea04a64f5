// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file's name says.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace ptin::tools {

/// ".tif" of "A/V.TIF"; empty when there is none.
[[nodiscard]] inline std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace ptin::tools
