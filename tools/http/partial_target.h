// SPDX-License-Identifier: GPL-3.0-or-later
//
// Facts of a target that is refused, or came in part.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/http/problem.h"
#include "tools/http/request.h"

namespace ptin::http {

/// The path of a target, as far as it came: a refusal has the form of what is answered there. Nothing
/// where it is no path.
[[nodiscard]] inline std::vector<std::string> path_of(std::string_view target) {
  try {
    return parse_target(target.substr(0, target.find_first_of("? \r\n"))).path;
  } catch (const Problem&) {
    return {};
  }
}

/// The target of a request of which the first line alone is known, or a part of it.
[[nodiscard]] inline std::string_view target_of_line(std::string_view line) {
  const std::size_t blank = line.find(' ');
  return blank == std::string_view::npos ? std::string_view() : line.substr(blank + 1);
}

}  // namespace ptin::http
