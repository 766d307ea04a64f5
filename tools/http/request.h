// SPDX-License-Identifier: GPL-3.0-or-later
//
// A request as it came, taken apart.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/http/forwarded.h"
#include "tools/http/memory_budget.h"

namespace ptin::http {

/// The names and values of a query, decoded, in the order in which they came.
using Parameters = std::vector<std::pair<std::string, std::string>>;

struct Target {
  std::vector<std::string> path;  ///< Decoded segments; "/" has none, "/a/" has "a" and "".
  Parameters parameters;
};

/// Takes the target of a request apart. A plus sign in the query is a blank.
/// @throws Problem 400  no path from the root; a percent sign without two hexadecimal digits; a
///                      zero byte, a line break, or bytes that are no UTF-8; more than 256
///                      parameters
[[nodiscard]] Target parse_target(std::string_view target);

/// The fields of a form (application/x-www-form-urlencoded).  @throws Problem 400 as parse_target()
[[nodiscard]] Parameters parse_form(std::string_view form);

/// A value of a query, of a form or of a path, decoded.  @throws Problem 400 as parse_target()
[[nodiscard]] std::string decode_percent(std::string_view text, bool plus_is_blank);

struct Request {
  std::uint64_t id = 0;    ///< Counts requests since the server began.
  std::string method;      ///< "GET".
  std::string target;      ///< As it came.
  bool is_parsed = false;  ///< Path and parameters are those of the target.
  std::vector<std::string> path;
  Parameters parameters;
  std::vector<std::pair<std::string, std::string>> headers;  ///< Names in lower case.
  std::string body;
  std::string remote;      ///< Address of the client, from a trusted proxy where there is one.
  std::string share;       ///< Under this name the client has its share.
  bool is_secure = false;  ///< A trusted proxy says that the client speaks HTTPS.
  Forwarded forwarded;     ///< What a trusted proxy says; empty of all other clients.
  /// What addresses of this server begin with in the answer: "" or "/terrain", and with a host before
  /// it where the service knows it; and the path in it. Service::enter() has set them.
  std::string base, prefix;
  /// Memory that was lent before the request is answered; gone once it was.
  std::shared_ptr<MemoryBudget::Lease> memory;
  std::stop_token stop;  ///< Fires when nobody waits for the answer any more.

  /// The header of this name (in lower case); the first one, where there are several.
  [[nodiscard]] std::optional<std::string_view> header(std::string_view name) const {
    for (const auto& [key, value] : headers) {
      if (key == name) return value;
    }
    return std::nullopt;
  }
};

}  // namespace ptin::http
