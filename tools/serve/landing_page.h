// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page that lists the terrains for people: pictures, facts, and where on the Earth they are. It has neither script nor style
// of its own, so that a policy of `default-src 'self'` holds.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "tools/serve/answer_parts.h"
#include "tools/serve/catalogue.h"

namespace ptin::serve {

/// A terrain with what /collections/ID says of it, of which the page reads `title` and `attribution`.
struct ListedTerrain {
  std::shared_ptr<const Collection> collection;
  Json told;
};

/// The page as HTML.
/// @param root  The path of the service on its host, without a slash at its end; it holds nothing that HTML would read.
[[nodiscard]] std::string landing_page(std::span<const ListedTerrain> terrains,
                                       const std::string& root);

/// Its style sheet.
[[nodiscard]] std::string_view landing_style() noexcept;

}  // namespace ptin::serve
