// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines over a relief, with labels that read uphill.
#pragma once

#include <functional>
#include <stop_token>

#include "engine/query/questions.h"
#include "tools/plot/canvas.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// Draws isolines; those of index levels heavier and with their heights, which stand along the line with
/// their heads uphill, as on topographic maps. Labels neither touch nor leave the map; where no index
/// line has room for one, the others have them.
/// @param is_index  Whether the lines of a height are drawn heavier.
/// @throws Error cancelled; as Isolines::line()
void draw_contours(Canvas& canvas, const Isolines& lines, const View& view,
                   const std::function<bool(double)>& is_index, const std::stop_token& stop = {});

}  // namespace ptin::tools
