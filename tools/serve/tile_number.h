// SPDX-License-Identifier: GPL-3.0-or-later
//
// The numbers of a tile in a path.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace ptin::serve {

struct TileNumber {
  std::int64_t level, x, y;
};

/// The numbers of "3/5/1.terrain"; none where the path is no such one. None is negative.
[[nodiscard]] std::optional<TileNumber> number_of_tile(std::string_view path,
                                                       std::string_view extension);

}  // namespace ptin::serve
