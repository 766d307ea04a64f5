// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/request.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "engine/utf8.h"
#include "tools/http/problem.h"

namespace ptin::http {

namespace {

constexpr std::size_t kMostParameters = 256;

int hex_digit(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_plain_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const auto c = static_cast<unsigned char>(text[0]);
    if (length == 0 || (c < 0x20 && c != '\t') || c == 0x7F) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

std::string decode_percent(std::string_view text, bool plus_is_blank) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
      if (high < 0 || low < 0) {
        throw Problem(400, "a percent sign stands without two hexadecimal digits; write %25");
      }
      decoded += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      decoded += plus_is_blank && text[i] == '+' ? ' ' : text[i];
    }
  }
  if (!is_plain_utf8(decoded)) {
    throw Problem(400, "the target holds control characters or bytes that are no UTF-8");
  }
  return decoded;
}

Parameters parse_form(std::string_view query) {
  Parameters parameters;
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (pair.empty()) continue;
    if (parameters.size() >= kMostParameters) {
      throw Problem(400, "more than " + std::to_string(kMostParameters) +
                             " parameters are given; no question has so many");
    }
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string_view value = pair.substr(std::min(equals + 1, pair.size()));
    parameters.emplace_back(decode_percent(pair.substr(0, equals), true),
                            decode_percent(value, true));
  }
  return parameters;
}

Target parse_target(std::string_view target) {
  // A client of a proxy names the whole URL.
  for (const std::string_view scheme : {"http://", "https://"}) {
    const bool is_of_scheme =
        target.size() >= scheme.size() &&
        std::equal(scheme.begin(), scheme.end(), target.begin(),
                   [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
    if (!is_of_scheme) continue;
    target.remove_prefix(scheme.size());
    const std::size_t root = target.find_first_of("/?");
    target = root == std::string_view::npos ? std::string_view("/") : target.substr(root);
  }
  if (target.empty() || target.front() != '/') {
    throw Problem(400, "the target is no path from the root; ask for / or a path below it");
  }
  Target parsed;
  const std::size_t mark = std::min(target.find('?'), target.size());
  std::string_view path = target.substr(1, mark > 0 ? mark - 1 : 0);
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    parsed.path.push_back(decode_percent(path.substr(0, end), false));
    if (end + 1 == path.size()) parsed.path.emplace_back();
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  parsed.parameters = parse_form(target.substr(std::min(mark + 1, target.size())));
  return parsed;
}

}  // namespace ptin::http
