// SPDX-License-Identifier: GPL-3.0-or-later
//
// Answers that are sent packed, and what caches are told of it.
#pragma once

#include <string>

#include "tools/http/response.h"

namespace ptin::serve {

/// Tells caches that an answer depends on a header, beside those that are told.
void add_vary(http::Response& response, const std::string& header);

/// Packs what packs well and is not small, for a client that takes it.
void pack(bool takes_gzip, http::Response& response);

}  // namespace ptin::serve
