// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lines before the body of an answer.
#pragma once

#include <string>

#include "tools/http/response.h"

namespace ptin::http {

/// @param keeps  The connection goes on after the answer.
/// Threads: the one of connections.
[[nodiscard]] std::string head_text(const Response& response, bool keeps);

}  // namespace ptin::http
