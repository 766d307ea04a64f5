// SPDX-License-Identifier: GPL-3.0-or-later
//
// The kind of a file that is none of ours, as far as its first bytes show.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ptin {

/// The number of first bytes that are looked at.
inline constexpr std::size_t kBeginningBytes = 64;

/// "it begins like a TIFF, as GeoTIFFs do; `ptin build` makes a .ptin file of it", "it is empty": what
/// stands behind the colon of "this is not a .ptin file: ". Never fails; an unknown beginning is
/// named as one.
/// @param first  The first bytes of the file, kBeginningBytes or all that it has.
[[nodiscard]] std::string beginning_of(std::span<const std::byte> first);

}  // namespace ptin
