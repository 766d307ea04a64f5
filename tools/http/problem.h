// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is wrong with a request, as RFC 9457 says it.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "tools/http/response.h"

namespace ptin::http {

constexpr std::string_view kProblemJson = "application/problem+json";

/// A request that is refused. Thrown where that is known, and answered where requests are.
class Problem : public std::exception {
 public:
  /// @param status  Status of HTTP, 400 to 599.
  /// @param detail  One sentence: what is wrong, what was expected, what to do.
  Problem(unsigned status, std::string detail) : status_(status), detail_(std::move(detail)) {}

  /// Names the parameter of the query, or the member of the body, that is at fault.
  Problem&& at(std::string parameter) && {
    parameter_ = std::move(parameter);
    return std::move(*this);
  }
  /// Names the limit that the request went beyond, by the name of the server's option.
  Problem&& beyond(std::string limit) && {
    limit_ = std::move(limit);
    return std::move(*this);
  }
  /// Names the methods that are answered here.
  Problem&& allow(std::string methods) && {
    methods_ = std::move(methods);
    return std::move(*this);
  }
  /// States how long the file is of which a range was asked for.
  Problem&& of_bytes(std::uint64_t bytes) && {
    whole_bytes_ = bytes;
    return std::move(*this);
  }
  /// States when to come again.
  Problem&& retry_after(unsigned seconds) && {
    retry_after_ = seconds;
    return std::move(*this);
  }

  [[nodiscard]] unsigned status() const noexcept { return status_; }
  [[nodiscard]] const std::string& detail() const noexcept { return detail_; }
  [[nodiscard]] const std::string& parameter() const noexcept { return parameter_; }
  [[nodiscard]] const std::string& limit() const noexcept { return limit_; }
  [[nodiscard]] const char* what() const noexcept override { return detail_.c_str(); }

  /// The answer: application/problem+json with type, title, status, detail, and where they are
  /// known `parameter` and `limit`.
  [[nodiscard]] Response response() const;

 private:
  unsigned status_;
  std::string detail_, parameter_, limit_, methods_;
  std::optional<std::uint64_t> whole_bytes_;
  std::optional<unsigned> retry_after_;
};

/// A client's text as a sentence quotes it: cut behind 64 bytes, at the end of a character.
[[nodiscard]] std::string shown(std::string_view text);

/// "Not Found" of 404; "Unknown" of a status that HTTP does not name.
[[nodiscard]] std::string reason_of(unsigned status);

}  // namespace ptin::http
