// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/tile_number.h"

#include <array>
#include <charconv>

namespace ptin::serve {

std::optional<TileNumber> number_of_tile(std::string_view path, std::string_view extension) {
  if (!path.ends_with(extension)) return std::nullopt;
  path.remove_suffix(extension.size());
  std::array<std::int64_t, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto [end, status] = std::from_chars(path.data(), path.data() + path.size(), numbers[i]);
    if (status != std::errc() || numbers[i] < 0) return std::nullopt;
    path.remove_prefix(static_cast<std::size_t>(end - path.data()));
    if (path.empty() != (i + 1 == numbers.size())) return std::nullopt;
    if (!path.empty() && path.front() != '/') return std::nullopt;
    if (!path.empty()) path.remove_prefix(1);
  }
  return TileNumber{numbers[0], numbers[1], numbers[2]};
}

}  // namespace ptin::serve
