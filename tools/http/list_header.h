// SPDX-License-Identifier: GPL-3.0-or-later
//
// Headers that hold a list, which a client may send in several lines (RFC 9110, section 5.3).
#pragma once

#include <string>
#include <string_view>

#include "tools/http/request.h"

namespace ptin::http {

/// All values of a header of this name (in lower case) with a comma between them; empty: there is
/// none.
[[nodiscard]] inline std::string list_of(const Request& request, std::string_view name) {
  std::string list;
  for (const auto& [key, value] : request.headers) {
    if (key == name) list.append(list.empty() ? "" : ",").append(value);
  }
  return list;
}

}  // namespace ptin::http
