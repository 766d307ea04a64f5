// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of records inside a segment of the file (DESIGN.md, section 5).
#pragma once

#include <span>

#include "storage/record.h"

namespace ptin {

/// Sorts by octave of the error (coarse first), wide before narrow, place of the roi's centre along
/// the Hilbert curve, then key of u. The result depends on the set of records alone, as long as no
/// u comes twice. Memory: 32 bytes a record, and a copy of the records.
void order_segment(std::span<VertexSplit> records);

}  // namespace ptin
