// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels as the bytes of a PNG, in memory.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace ptin::tools {

/// @param pixels  Row by row from the upper left: opacity, red, green and blue in 8 bits each, blue
///                lowest, colours not multiplied by the opacity.
/// REQUIRES: width * height pixels, both above 0
/// @throws Error resource_exhausted  Cairo is refused memory
[[nodiscard]] std::string png_of(int width, int height, std::span<const std::uint32_t> pixels);

}  // namespace ptin::tools
