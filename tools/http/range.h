// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of answers (RFC 9110, section 14).
#pragma once

#include "tools/http/request.h"
#include "tools/http/response.h"

namespace ptin::http {

/// States that an answer of 200 with a strong tag is given by ranges of bytes, too, and where a
/// GET asks for one leaves that range of it, with status 206. A range of a form that is not known is
/// ignored, and so is one whose If-Range is another tag or any date. A range that begins behind the
/// last byte, and several ranges, make it a refusal of status 416.
void select_range(const Request& request, Response& response);

}  // namespace ptin::http
