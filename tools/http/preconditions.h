// SPDX-License-Identifier: GPL-3.0-or-later
//
// Requests that depend on what the client has (RFC 9110, section 13).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tools/http/request.h"
#include "tools/http/response.h"

namespace ptin::http {

/// Makes an answer that has a tag, 200 or 304, a refusal of status 412 where If-Match names
/// neither the tag nor its other form under gzip, or where there is no If-Match and
/// If-Unmodified-Since is before its Last-Modified. A weak tag is never the same.
void check_preconditions(const Request& request, Response& response);

/// Whether a GET or HEAD of what has a strong tag and a date is answered by 304: If-None-Match is `*`
/// or names the tag, its other form under gzip or their weak ones, or where there is no If-None-Match
/// If-Modified-Since is not before the date.
[[nodiscard]] bool is_unchanged(const Request& request, const std::string& etag,
                                std::int64_t modified);

/// A date as RFC 9110 has it, "Sun, 06 Nov 1994 08:49:37 GMT".
[[nodiscard]] std::string date_text(std::int64_t seconds);
/// Seconds since 1970 of such a date; none: it is of another form.
[[nodiscard]] std::optional<std::int64_t> seconds_of_date(const std::string& text);

}  // namespace ptin::http
