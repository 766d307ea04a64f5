// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/etag.h"

#include <array>

#include <xxhash.h>

namespace ptin::http {

namespace {

/// Takes the next tag of a list, with its quotes, and `W/` where it is weak; empty: no further one.
std::string_view next_tag(std::string_view& list) {
  while (!list.empty() && (list.front() == ' ' || list.front() == ',' || list.front() == '\t')) {
    list.remove_prefix(1);
  }
  const std::size_t opening = list.starts_with("W/") ? 2 : 0;
  const bool is_tag = list.size() > opening && list[opening] == '"';
  const std::size_t closing = is_tag ? list.find('"', opening + 1) : std::string_view::npos;
  if (closing == std::string_view::npos) return {};
  const std::string_view tag = list.substr(0, closing + 1);
  list.remove_prefix(closing + 1);
  return tag;
}

}  // namespace

std::string hex_of(std::uint64_t number) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; number >>= 4) text[i] = kDigits[number & 15U];
  return text;
}

std::string etag_of(std::string_view text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return "\"" + hex_of(hash.high64) + hex_of(hash.low64) + "\"";
}

std::string gzip_etag_of(const std::string& etag) {
  return etag.substr(0, etag.size() - 1) + "-gz\"";
}

bool names_etag(std::string_view list, const std::string& etag, bool weak_too) {
  constexpr std::string_view kPacked = "-gz\"";
  const std::string other = etag.ends_with(kPacked)
                                ? etag.substr(0, etag.size() - kPacked.size()) + "\""
                                : gzip_etag_of(etag);
  for (std::string_view tag = next_tag(list); !tag.empty(); tag = next_tag(list)) {
    if (weak_too && tag.starts_with("W/")) tag.remove_prefix(2);
    if (tag == etag || tag == other) return true;
  }
  return false;
}

}  // namespace ptin::http
