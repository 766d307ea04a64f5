// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/access.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr std::string_view kParameter = "token";
constexpr std::string_view kCookie = "ptin_token=";

char digit_of(unsigned value) { return "0123456789abcdef"[value & 0xFU]; }

/// A text in digits that a cookie and an address may hold.
std::string hex_of_text(std::string_view text) {
  std::string hex;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    hex += digit_of(byte >> 4U);
    hex += digit_of(byte);
  }
  return hex;
}

std::string encoded(std::string_view text) {
  std::string code;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || std::string_view("-._~,").find(c) != std::string_view::npos) {
      code += c;
    } else {
      code += '%';
      code += digit_of(byte >> 4U);
      code += digit_of(byte);
    }
  }
  return code;
}

/// The address on this server that a request asks for, without the token. It begins with one slash:
/// with two it would be another server's.
std::string target_without_token(const http::Request& request) {
  std::string target;
  bool has_begun = false;
  for (const std::string& segment : request.path) {
    has_begun = has_begun || !segment.empty();
    if (has_begun) target += "/" + encoded(segment);
  }
  if (target.empty()) target = "/";
  char before = '?';
  for (const auto& [name, value] : request.parameters) {
    if (name == kParameter) continue;
    target += before + encoded(name) + "=" + encoded(value);
    before = '&';
  }
  return target;
}

bool is_bearer(std::string_view scheme) {
  constexpr std::string_view kBearer = "bearer ";
  return std::equal(
      scheme.begin(), scheme.end(), kBearer.begin(), kBearer.end(),
      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// Compares in a time that does not tell how many bytes were right.
bool is_same_secret(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0U : 1U;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const char c = given.empty() ? '\0' : given[i % given.size()];
    difference |= static_cast<unsigned char>(c ^ secret[i]);
  }
  return difference == 0;
}

/// Whether a cookie of the request holds the token; of those with its name any one may.
bool has_cookie(const http::Request& request, const std::string& token) {
  const std::string expected = hex_of_text(token);
  for (const auto& [name, value] : request.headers) {
    if (name != "cookie") continue;
    std::string_view list = value;
    while (!list.empty()) {
      const std::size_t end = std::min(list.find(';'), list.size());
      std::string_view one = list.substr(0, end);
      list.remove_prefix(std::min(end + 1, list.size()));
      while (one.starts_with(' ')) one.remove_prefix(1);
      if (!one.starts_with(kCookie)) continue;
      if (is_same_secret(one.substr(kCookie.size()), expected)) return true;
    }
  }
  return false;
}

}  // namespace

Access::Access(std::string token, MetricsFor metrics)
    : token_(std::move(token)), metrics_(metrics) {
  if (metrics_ == MetricsFor::kDefault) {
    metrics_ = token_.empty() ? MetricsFor::kAll : MetricsFor::kToken;
  }
}

void Access::check(const http::Request& request) const {
  if (token_.empty()) return;
  constexpr std::size_t kScheme = 7;  // Bytes of "Bearer " before the token.
  const std::string_view given = request.header("authorization").value_or("");
  if (is_bearer(given.substr(0, kScheme)) && is_same_secret(given.substr(kScheme), token_)) return;
  if (has_cookie(request, token_)) return;
  throw Problem(401,
                "this service wants a token; send it as Authorization: Bearer TOKEN, or open this "
                "address in a browser once with ?token=TOKEN");
}

void Access::check_metrics(const http::Request& request) const {
  if (metrics_ == MetricsFor::kNobody) {
    throw Problem(403, "this service does not tell its metrics; it would with --metrics open");
  }
  if (metrics_ == MetricsFor::kToken) check(request);
}

bool Access::is_login(const http::Request& request) const {
  return needs_token() && (request.method == "GET" || request.method == "HEAD") &&
         std::any_of(request.parameters.begin(), request.parameters.end(),
                     [](const auto& parameter) { return parameter.first == kParameter; });
}

http::Response Access::login(const http::Request& request) const {
  std::string_view given;
  for (const auto& [name, value] : request.parameters) {
    if (name == kParameter) given = value;
  }
  if (!is_same_secret(given, token_)) throw Problem(401, "this is not the token of this service");
  http::Response response;
  response.status = 303;
  // Without a host: what a header says of it leads nobody elsewhere.
  response.add("Location", request.prefix + target_without_token(request));
  response.add("Set-Cookie", std::string(kCookie) + hex_of_text(token_) +
                                 "; Path=" + (request.prefix.empty() ? "/" : request.prefix) +
                                 "; HttpOnly; SameSite=Strict" +
                                 (request.is_secure ? "; Secure" : ""));
  response.add("Cache-Control", "no-store");
  response.add("Referrer-Policy", "no-referrer");
  return response;
}

std::string target_for_log(const http::Request& request) {
  if (request.target.find(kParameter) == std::string::npos &&
      request.target.find('%') == std::string::npos) {
    return request.target;
  }
  if (!request.is_parsed) return request.target.substr(0, request.target.find('?'));
  const bool has_token =
      std::any_of(request.parameters.begin(), request.parameters.end(),
                  [](const auto& parameter) { return parameter.first == kParameter; });
  return has_token ? target_without_token(request) : request.target;
}

}  // namespace ptin::serve
