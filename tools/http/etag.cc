// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/etag.h"

#include <array>

#include <xxhash.h>

namespace ptin::http {

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

bool names_etag(std::string_view if_none_match, const std::string& etag) {
  return if_none_match.find(etag) != std::string_view::npos ||
         if_none_match.find(gzip_etag_of(etag)) != std::string_view::npos;
}

}  // namespace ptin::http
