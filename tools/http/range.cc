// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/range.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "tools/http/problem.h"

namespace ptin::http {

namespace {

/// The first and the last byte of a range.
struct Range {
  std::uint64_t first, last;
};

/// One beyond all that there can be is the largest one.
std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_beyond = status == std::errc::result_out_of_range;
  if (is_beyond) number = std::numeric_limits<std::uint64_t>::max();
  if ((status != std::errc() && !is_beyond) || end != text.data() + text.size())
    return std::nullopt;
  return number;
}

[[noreturn]] void throw_unsatisfiable(const std::string& why, std::uint64_t bytes) {
  throw Problem(416, why).of_bytes(bytes);
}

/// The unit is a word of HTTP: capitals do not matter.
bool is_of_bytes(std::string_view header) {
  constexpr std::string_view kUnit = "bytes=";
  return header.size() >= kUnit.size() &&
         std::equal(kUnit.begin(), kUnit.end(), header.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

/// The range of a header; none where it is of no form that is known, and then is to be ignored (RFC
/// 9110, section 14.2).
std::optional<Range> range_of(std::string_view header, std::uint64_t bytes) {
  if (!is_of_bytes(header)) return std::nullopt;
  header.remove_prefix(header.find('=') + 1);
  if (bytes == 0) throw_unsatisfiable("there are no bytes", bytes);
  if (header.find(',') != std::string_view::npos) {
    throw_unsatisfiable("one range is answered at once; ask for others by requests of their own",
                        bytes);
  }
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first = whole_number(header.substr(0, dash));
  const auto last = whole_number(header.substr(dash + 1));
  if (!first && dash == 0 && last) {
    if (*last == 0) throw_unsatisfiable("a range of no bytes", bytes);
    return Range{bytes - std::min(bytes, *last), bytes - 1};
  }
  if (!first || (!last && dash + 1 != header.size())) return std::nullopt;
  if (last && *last < *first) return std::nullopt;
  if (*first >= bytes) {
    throw_unsatisfiable(
        "there are " + std::to_string(bytes) + " bytes, and the range begins behind them", bytes);
  }
  return Range{*first, std::min(last.value_or(bytes - 1), bytes - 1)};
}

/// Leaves the bytes of a range of an answer.
void cut(Response& response, const Range& range) {
  const std::uint64_t bytes = range.last - range.first + 1;
  if (response.long_body) {
    response.long_body->read = [whole = std::move(response.long_body->read), first = range.first](
                                   std::uint64_t offset, std::span<char> into) {
      whole(first + offset, into);
    };
    response.long_body->bytes = bytes;
  } else if (!response.lasting_body.empty()) {
    response.lasting_body = response.lasting_body.substr(range.first, bytes);
  } else {
    response.body = response.body.substr(range.first, bytes);
  }
}

std::string strong_etag_of(const Response& response) {
  for (const auto& [name, value] : response.headers) {
    if (name == "ETag" && value.starts_with('"')) return value;
  }
  return {};
}

}  // namespace

void select_range(const Request& request, Response& response) {
  const std::string etag = strong_etag_of(response);
  if (response.status != 200 || etag.empty()) return;
  response.add("Accept-Ranges", "bytes");
  const auto header = request.header("range"), if_range = request.header("if-range");
  // A weak tag or a date does not say that every byte is the same.
  if (request.method != "GET" || !header || (if_range && *if_range != etag)) return;
  const std::uint64_t bytes = response.body_bytes();
  try {
    const std::optional<Range> range = range_of(*header, bytes);
    if (!range) return;
    cut(response, *range);
    response.status = 206;
    response.add("Content-Range", "bytes " + std::to_string(range->first) + "-" +
                                      std::to_string(range->last) + "/" + std::to_string(bytes));
  } catch (const Problem& problem) {
    response = problem.response();
  }
}

}  // namespace ptin::http
