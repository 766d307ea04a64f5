// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/forwarded.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "engine/web_address.h"
#include "tools/http/letters.h"

namespace ptin::http {

namespace {

constexpr std::size_t kMostBytesOfPart = 255;

std::string_view without_blanks(std::string_view text) noexcept {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// What stands in a list between separators that are in no quotes.
std::vector<std::string_view> unquoted_parts(std::string_view list, char separator) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i <= list.size(); ++i) {
    if (i < list.size() && list[i] == '"') is_quoted = !is_quoted;
    if (i < list.size() && (list[i] != separator || is_quoted)) continue;
    parts.push_back(without_blanks(list.substr(begin, i - begin)));
    begin = i + 1;
  }
  return parts;
}

/// The last value that headers of a name tell.
std::string_view last_of(const Headers& headers, std::string_view name) {
  std::string_view last;
  for (const auto& [key, value] : headers) {
    if (key != name) continue;
    const std::size_t comma = value.rfind(',');
    last = std::string_view(value).substr(comma == std::string::npos ? 0 : comma + 1);
  }
  return without_blanks(last);
}

/// A list over all headers of a name.
std::string list_in(const Headers& headers, std::string_view name) {
  std::string list;
  for (const auto& [key, value] : headers) {
    if (key == name) list += (list.empty() ? "" : ",") + value;
  }
  return list;
}

/// The value of a pair of Forwarded, "host=..."; without its quotes.
std::optional<std::string_view> value_in(std::string_view pair, std::string_view name) {
  const std::size_t equals = pair.find('=');
  if (equals == std::string_view::npos || lower_letters(pair.substr(0, equals)) != name) {
    return std::nullopt;
  }
  std::string_view value = pair.substr(equals + 1);
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') {
    value = value.substr(1, value.size() - 2);
  }
  return value;
}

/// Puts what the header Forwarded tells where nothing stands yet.
void add_standard(const std::string& list, Forwarded& told) {
  Forwarded last;
  for (const std::string_view element : unquoted_parts(list, ',')) {
    last.proto = last.host = "";
    for (const std::string_view pair : unquoted_parts(element, ';')) {
      if (const auto proto = value_in(pair, "proto")) last.proto = *proto;
      if (const auto host = value_in(pair, "host")) last.host = *host;
      const auto client = value_in(pair, "for");
      if (client) last.client.append(last.client.empty() ? "" : ",").append(*client);
    }
  }
  if (told.proto.empty()) told.proto = last.proto;
  if (told.host.empty()) told.host = last.host;
  if (told.client.empty()) told.client = last.client;
}

}  // namespace

bool is_path_prefix(std::string_view text) noexcept {
  if (text.size() > kMostBytesOfPart) return false;
  while (!text.empty()) {
    if (text.front() != '/') return false;
    const std::size_t end = std::min(text.find('/', 1), text.size());
    const std::string_view segment = text.substr(1, end - 1);
    const bool is_plain = std::all_of(segment.begin(), segment.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '~' ||
             c == '.';
    });
    if (segment.empty() || segment == "." || segment == ".." || !is_plain) return false;
    text.remove_prefix(end);
  }
  return true;
}

Forwarded forwarded_of(const Headers& headers) {
  Forwarded told;
  told.proto = last_of(headers, "x-forwarded-proto");
  told.host = last_of(headers, "x-forwarded-host");
  told.prefix = last_of(headers, "x-forwarded-prefix");
  told.client = list_in(headers, "x-forwarded-for");
  if (const std::string standard = list_in(headers, "forwarded"); !standard.empty()) {
    add_standard(standard, told);
  }
  told.proto = lower_letters(told.proto);
  if (told.proto != "http" && told.proto != "https") told.proto.clear();
  if (!is_host(told.host)) told.host.clear();
  while (told.prefix.ends_with('/')) told.prefix.pop_back();
  if (!is_path_prefix(told.prefix)) told.prefix.clear();
  return told;
}

}  // namespace ptin::http
