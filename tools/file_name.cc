// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/file_name.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "engine/error.h"

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

bool is_there(const std::string& path) {
  std::error_code fault;
  const bool found = std::filesystem::exists(path, fault);
  if (fault) throw system_error(fault.value(), "cannot look for it", path);
  return found;
}

std::uint64_t file_bytes(const std::string& path) {
  std::error_code fault;
  const std::uint64_t bytes = std::filesystem::file_size(path, fault);
  if (fault) throw system_error(fault.value(), "cannot tell its size", path);
  return bytes;
}

}  // namespace ptin::tools
