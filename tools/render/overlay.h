// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is drawn over the relief: the edges of the triangles.
#pragma once

#include <stop_token>

#include "tools/plot/canvas.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// Draws every edge of the TIN that the view shows once. Opacity falls with an edge's length, so that a
/// part of any density is covered by a quarter at most, and the relief below it stays legible.
/// @throws Error cancelled
void draw_wireframe(Canvas& canvas, const RefinedTin& refined, const StoreFacts& facts,
                    const View& view, const std::stop_token& stop = {});

}  // namespace ptin::tools
