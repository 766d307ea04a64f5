// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a trusted proxy says of the address under which its clients know this server.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ptin::http {

/// Each part is empty where the proxy said nothing, or nothing that an address may hold: a line break,
/// a blank or a quote never gets into an answer from here.
struct Forwarded {
  std::string proto;   ///< "http" or "https".
  std::string host;    ///< "example.org", "example.org:8443", "[2001:db8::1]:8443".
  std::string prefix;  ///< "/terrain": begins with a slash and ends with none.
  std::string client;  ///< Addresses between commas, the last proxy's last, as X-Forwarded-For.
};

using Headers = std::vector<std::pair<std::string, std::string>>;  // Names in lower case.

/// Reads X-Forwarded-Proto, -Host, -Prefix and -For; what is not there, from Forwarded (RFC 7239),
/// which knows no prefix. Of a list of several proxies the last one counts, which wrote to this server
/// itself: anybody may have written what stands before it.
[[nodiscard]] Forwarded forwarded_of(const Headers& headers);

/// "" or "/terrain", "/a/b": segments of letters, digits, `-`, `_`, `~` and `.`, none of them `.` or `..`.
[[nodiscard]] bool is_path_prefix(std::string_view text) noexcept;

}  // namespace ptin::http
