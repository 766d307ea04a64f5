// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/problem.h"

#include <string>

#include <boost/beast/http/status.hpp>
#include <nlohmann/json.hpp>

namespace ptin::http {

std::string reason_of(unsigned status) {
  const auto name = boost::beast::http::obsolete_reason(boost::beast::http::int_to_status(status));
  return name == "<unknown-status>" ? "Unknown" : std::string(name);
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 64;
  if (text.size() <= kMost) return std::string(text);
  std::size_t end = kMost;  // Bytes that go on with a character are 10xxxxxx.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return std::string(text.substr(0, end)) + "...";
}

Response Problem::response() const {
  nlohmann::ordered_json json = {{"type", "about:blank"},
                                 {"title", reason_of(status_)},
                                 {"status", status_},
                                 {"detail", detail_}};
  if (!parameter_.empty()) json["parameter"] = parameter_;
  if (!limit_.empty()) json["limit"] = limit_;
  Response response;
  response.status = status_;
  response.content_type = kProblemJson;
  // What a client sent may be no UTF-8: such bytes are written as U+FFFD.
  response.body = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (retry_after_) response.add("Retry-After", std::to_string(*retry_after_));
  if (!methods_.empty()) response.add("Allow", methods_);
  if (whole_bytes_) response.add("Content-Range", "bytes */" + std::to_string(*whole_bytes_));
  if (status_ == 401) response.add("WWW-Authenticate", "Bearer");
  if (status_ == 415) response.add("Accept-Encoding", "identity");
  return response;
}

}  // namespace ptin::http
