// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of addresses of the web that come from outside.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>

namespace ptin {

/// The most bytes of a host that counts as one: a name has at most 255 octets (RFC 1035, 2.3.4).
inline constexpr std::size_t kMostBytesOfHost = 255;

/// Whether a text is a port's number as it stands in an address.
[[nodiscard]] inline bool is_port(std::string_view text) noexcept {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether a text is a host with its port or without: "example.org:8443", "[2001:db8::1]".
[[nodiscard]] inline bool is_host(std::string_view text) noexcept {
  if (text.empty() || text.size() > kMostBytesOfHost) return false;
  std::size_t end = std::min(text.find(':'), text.size());
  if (text.front() == '[') {
    end = text.find(']');
    if (end == std::string_view::npos || end == 1) return false;
    const std::string_view number = text.substr(1, end - 1);
    const bool is_number = std::all_of(number.begin(), number.end(), [](char c) {
      return std::isxdigit(static_cast<unsigned char>(c)) != 0 || c == ':' || c == '.';
    });
    if (!is_number) return false;
    ++end;
  } else {
    const std::string_view name = text.substr(0, end);
    const bool is_name = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' || c == '_';
    });
    if (!is_name) return false;
  }
  return end == text.size() || (text[end] == ':' && is_port(text.substr(end + 1)));
}

/// "https://tiles.example.org:8443" of an address of http or https: all up to its path; empty where it is none.
[[nodiscard]] inline std::string_view origin_of(std::string_view address) noexcept {
  for (const std::string_view scheme :
       {std::string_view("http://"), std::string_view("https://")}) {
    if (!address.starts_with(scheme)) continue;
    const std::size_t end = std::min(address.find_first_of("/?#", scheme.size()), address.size());
    if (is_host(address.substr(scheme.size(), end - scheme.size()))) return address.substr(0, end);
  }
  return {};
}

}  // namespace ptin
