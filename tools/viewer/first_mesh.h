// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first picture of a terrain, as data in the page itself: drawn before the decoder and the stream have come.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace ptin::tools {

/// The mesh that the first frames of a stream make, of about a thousand vertices, as an element of
/// HTML; src/first_mesh.ts reads it. It carries the facts and the metadata of the stream and the
/// mesh's certificate. Heights that are floats are rounded to steps of at most 1/32767 of the relief,
/// and the certificate is as much wider. Where a stream certifies nothing before it has many thousand
/// vertices, as with many voids, it is a preview: heights of that mesh at a lattice of 33 places along
/// the longer side, with null for the error and the deviation, since of what is between nothing is
/// certified. Empty where the beginning makes no mesh.
/// @param beginning  The first bytes of a stream; it may be cut anywhere.
/// @throws Error as StreamReader::feed
/// Cost: linear.
[[nodiscard]] std::string first_mesh_element(std::span<const std::byte> beginning);

/// Whether an element of first_mesh_element() is a preview.
[[nodiscard]] bool is_preview(std::string_view element);

}  // namespace ptin::tools
