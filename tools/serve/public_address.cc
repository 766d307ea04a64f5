// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/public_address.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "engine/error.h"
#include "engine/web_address.h"
#include "tools/serve/endpoint.h"

namespace ptin::serve {

namespace {

/// The segments of "/a/b".
std::vector<std::string_view> segments_of(std::string_view prefix) {
  std::vector<std::string_view> segments;
  while (!prefix.empty()) {
    const std::size_t end = std::min(prefix.find('/', 1), prefix.size());
    segments.push_back(prefix.substr(1, end - 1));
    prefix.remove_prefix(end);
  }
  return segments;
}

/// Whether a prefix begins as a path of the service does: nobody could tell whether a proxy took it
/// away.
bool is_taken(std::string_view prefix) {
  const std::vector<std::string_view> segments = segments_of(prefix);
  if (segments.empty()) return false;
  if (std::find(kQuickPaths.begin(), kQuickPaths.end(), segments[0]) != kQuickPaths.end()) {
    return true;
  }
  return std::any_of(endpoints().begin(), endpoints().end(), [&](const Endpoint& endpoint) {
    const std::vector<std::string_view> own = segments_of(endpoint.path);
    return !own.empty() && own[0] == segments[0];
  });
}

[[noreturn]] void throw_no_public_url(const std::string& url, const std::string& where) {
  refuse(
      "\"" + url +
          "\" is no public address; expected http:// or https://, a host, and a path of letters, "
          "digits, -, _, ~ and . where there is one, as https://example.org/terrain/",
      where);
}

}  // namespace

PublicAddress public_address_of(const std::string& url, const std::string& where) {
  std::string_view rest = url;
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!rest.starts_with(scheme)) continue;
    rest.remove_prefix(scheme.size());
    const std::size_t end = std::min(rest.find('/'), rest.size());
    std::string_view prefix = rest.substr(end);
    while (prefix.ends_with('/')) prefix.remove_suffix(1);
    if (!is_host(rest.substr(0, end)) || !http::is_path_prefix(prefix)) break;
    if (is_taken(prefix)) {
      refuse("the path of the public address begins as one of the service's own, " +
                 std::string(prefix) + "; choose another one, as /terrain/",
             where);
    }
    return {std::string(scheme).append(rest.substr(0, end)), std::string(prefix)};
  }
  throw_no_public_url(url, where);
}

void enter_by(const PublicAddress& configured, http::Request& request) {
  const http::Forwarded& told = request.forwarded;
  if (configured.is_known()) {
    request.base = configured.origin + configured.prefix;
    request.prefix = configured.prefix;
  } else {
    request.prefix = is_taken(told.prefix) ? std::string() : told.prefix;
    request.base = request.prefix;
    if (!told.host.empty()) {
      const std::string scheme = told.proto.empty() ? "http" : told.proto;
      request.base = scheme + "://" + told.host + request.prefix;
    }
  }
  const std::vector<std::string_view> prefix = segments_of(request.prefix);
  std::vector<std::string>& path = request.path;
  if (prefix.empty() || path.size() < prefix.size()) return;
  if (!std::equal(prefix.begin(), prefix.end(), path.begin())) return;
  path.erase(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(prefix.size()));
  // "/terrain/" is the root, as "/" is.
  if (path.size() == 1 && path[0].empty()) path.clear();
}

}  // namespace ptin::serve
