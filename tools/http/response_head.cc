// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/response_head.h"

#include <array>
#include <ctime>

#include "tools/http/problem.h"

namespace ptin::http {

namespace {

/// The time as RFC 9110 has it. The one thread of connections asks.
const std::string& date_now() {
  static std::time_t written = 0;
  static std::string text;
  if (const std::time_t now = std::time(nullptr); now != written) {
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    std::array<char, 40> date{};
    std::strftime(date.data(), date.size(), "%a, %d %b %Y %H:%M:%S GMT", &parts);
    text = date.data();
    written = now;
  }
  return text;
}

}  // namespace

std::string head_text(const Response& response, bool keeps) {
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " ";
  head += reason_of(response.status) + "\r\nServer: ptin\r\nDate: " + date_now() + "\r\n";
  if (!response.content_type.empty()) head += "Content-Type: " + response.content_type + "\r\n";
  for (const auto& [name, value] : response.headers) head += name + ": " + value + "\r\n";
  if (response.status != 204 && response.status != 304) {
    head += "Content-Length: " + std::to_string(response.body_bytes()) + "\r\n";
  }
  return head + (keeps ? "Connection: keep-alive\r\n\r\n" : "Connection: close\r\n\r\n");
}

}  // namespace ptin::http
