// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refusals of requests that are read.
#include <cctype>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <boost/beast/core/string.hpp>
#include <boost/beast/http/error.hpp>

#include "tools/http/connection.h"
#include "tools/http/partial_target.h"

namespace ptin::http {

namespace {

namespace beast_http = boost::beast::http;

/// Whether a first line ends with a version of HTTP, whichever.
bool names_version(std::string_view line) {
  constexpr std::string_view kForm = "HTTP/0.0";
  if (line.size() <= kForm.size()) return false;
  const std::string_view end = line.substr(line.size() - kForm.size());
  return end.starts_with("HTTP/") && std::isdigit(static_cast<unsigned char>(end[5])) != 0 &&
         end[6] == '.' && std::isdigit(static_cast<unsigned char>(end[7])) != 0;
}

}  // namespace

/// A framing that a proxy before this server might read in another way: it would take the body of one request
/// for another one (RFC 9112, sections 3.2 and 6.1).
std::optional<Problem> Connection::problem_of_framing() const {
  const auto& head = parser_->get();
  const auto coding = head["Transfer-Encoding"];
  if (!coding.empty() && (!boost::beast::iequals(coding, "chunked") || head.version() < 11)) {
    return Problem(501,
                   "the body comes in a transfer coding that is not answered; send it chunked, "
                   "or with Content-Length");
  }
  if (head.version() >= 11 && head.count("Host") != 1) {
    return Problem(400, "a request of HTTP/1.1 has one header Host");
  }
  return std::nullopt;
}

/// The text in the buffer up to the end of a line, or all of it.
std::string_view Connection::begun_line() const {
  const auto* const bytes = static_cast<const char*>(buffer_.data().data());
  const std::string_view begun(bytes, buffer_.size());
  return begun.substr(0, begun.find("\r\n"));
}

Problem Connection::problem_of_head(const Status& status) const {
  const Limits& limits = host_.limits;
  if (status == beast_http::error::body_limit) {
    return Problem(413, "the body is larger than " + std::to_string(limits.body_bytes) +
                            " bytes; send less at once")
        .beyond("body_bytes");
  }
  if (has_head_ && framing_ > limits.header_bytes) {
    return Problem(431, "extensions and trailers of the body in chunks take more than " +
                            std::to_string(limits.header_bytes) + " bytes; send fewer")
        .beyond("header_bytes");
  }
  if (status == beast_http::error::header_limit || status == beast_http::error::buffer_overflow) {
    const bool has_line = parser_->get().target().size() > 0
                              ? parser_->get().target().size() <= limits.request_line_bytes
                              : begun_line().size() < limits.request_line_bytes;
    if (!has_line) {
      return Problem(414, "the first line of the request is longer than " +
                              std::to_string(limits.request_line_bytes) +
                              " bytes; send the question as the body of a POST")
          .beyond("request_line_bytes");
    }
    return Problem(431, "the header lines take more than " + std::to_string(limits.header_bytes) +
                            " bytes; send fewer")
        .beyond("header_bytes");
  }
  if (status == beast_http::error::bad_version && names_version(begun_line())) {
    return {505, "HTTP/1.1 and HTTP/1.0 are answered here; ask by one of them"};
  }
  return {400, "the request is no HTTP/1.1: " + status.message()};
}

/// The deadline of reading passed.
void Connection::refuse_late() {
  if (is_short_) {
    return refuse(
        Problem(503, "the requests at hand take all memory that the server has; come again later")
            .beyond("memory_bytes")
            .retry_after(1));
  }
  // Nothing came before the deadline: there is nobody to tell.
  if (buffer_.size() == 0 && !parser_->got_some()) return close();
  refuse(Problem(408, "the request did not arrive within " +
                          std::to_string(host_.limits.reading.count()) + " ms; send it at once")
             .beyond("reading"));
}

void Connection::refuse(const Problem& problem) {
  is_short_ = false;
  if (!has_head_) {
    request_ = std::make_shared<Request>();
    request_->id = host_.next_request++;
    request_->remote = peer_.to_string();
    if (parser_) {
      const auto& target = parser_->get().target();
      request_->path = path_of(
          !target.empty()
              ? std::string_view(target.data(), target.size())
              : target_of_line({static_cast<const char*>(buffer_.data().data()), buffer_.size()}));
      host_.service.enter(*request_);
    }
  }
  Response response = problem.response();
  host_.service.finish(*request_, response);
  write(std::move(response), true);
}

}  // namespace ptin::http
