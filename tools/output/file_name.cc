// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/file_name.h"

#include <algorithm>
#include <filesystem>

namespace ptin::tools {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

std::string lower_extension(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

}  // namespace ptin::tools
