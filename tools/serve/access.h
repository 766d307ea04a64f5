// SPDX-License-Identifier: GPL-3.0-or-later
//
// The right to ask: the token of a service, as a header, or as a cookie for browsers.
#pragma once

#include <string>

#include "tools/http/request.h"
#include "tools/http/response.h"
#include "tools/serve/serve_options.h"

namespace ptin::serve {

/// Immutable. Threads: any.
class Access {
 public:
  /// @param token  Empty: no question needs one.
  Access(std::string token, MetricsFor metrics);

  [[nodiscard]] bool needs_token() const noexcept { return !token_.empty(); }
  /// @throws http::Problem 401  the token is neither in Authorization nor in the cookie
  void check(const http::Request& request) const;
  /// @throws http::Problem 401 as check()
  ///                       403  nobody may read them
  void check_metrics(const http::Request& request) const;

  /// Whether the token stands in the address: what a person opens in a browser.
  [[nodiscard]] bool is_login(const http::Request& request) const;
  /// The token as a cookie, and the way to the same address without it.
  /// @throws http::Problem 401  it is another one
  [[nodiscard]] http::Response login(const http::Request& request) const;

 private:
  std::string token_;
  MetricsFor metrics_;
};

/// The target of a request as a log may hold it: without a token.
[[nodiscard]] std::string target_for_log(const http::Request& request);

}  // namespace ptin::serve
