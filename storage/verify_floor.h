// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the heights of a raster in a file are as they are to be written.
#pragma once

#include <functional>
#include <string>

#include "storage/file/readable_file.h"
#include "storage/store_front.h"

namespace ptin {

/// Hears what is wrong, and where.
using TellFault = std::function<void(std::string what, std::string where)>;

/// Looks at every node, page and tile of the heights: checksums; entries that are the unions of what they
/// describe; zeros; each tile once, none missing; pages packed in their one form; the range and the number
/// of heights as in the header; such heights as the source can have had; and as many vertices as samples. What lies below a damaged node cannot be
/// looked at. Whether the heights are those of the vertices, check_hierarchy() finds out.
/// @param check_stop  Called now and then; throws what it likes.
/// REQUIRES: the file has such sections.
/// @throws Error io_error; what the functions throw
/// Cost: one reading, about 15 ns a sample. Memory: some pages.
void verify_floor(const ReadableFile& file, const StoreFront& front, const TellFault& tell,
                  const std::function<void()>& check_stop);

}  // namespace ptin
