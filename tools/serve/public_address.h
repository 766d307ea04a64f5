// SPDX-License-Identifier: GPL-3.0-or-later
//
// Under which address clients know the service, and the part of it that a path may begin with.
#pragma once

#include <string>

#include "tools/http/request.h"

namespace ptin::serve {

/// What every absolute address in an answer begins with.
struct PublicAddress {
  std::string origin;  ///< "https://example.org"; empty: not known, addresses are paths.
  std::string prefix;  ///< "/terrain"; empty: the root.

  [[nodiscard]] bool is_known() const noexcept { return !origin.empty() || !prefix.empty(); }
};

/// Of "https://example.org/terrain/".
/// @param where  Gave it, for the error.
/// @throws Error invalid_argument  no URL of http or https; it has a user, a query or a fragment; its
///               path holds what a path of the service begins with, or other signs than is_path_prefix()
[[nodiscard]] PublicAddress public_address_of(const std::string& url, const std::string& where);

/// Sets `base` and `prefix` of a request, and takes the prefix away from its path where the proxy has
/// left it there.
/// @param configured  Counts where it is known; else what a trusted proxy says.
void enter_by(const PublicAddress& configured, http::Request& request);

}  // namespace ptin::serve
