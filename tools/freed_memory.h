// SPDX-License-Identifier: GPL-3.0-or-later
//
// The allocator's treatment of memory that a build has freed.
#pragma once

#include "engine/construct/build_plan.h"

namespace ptin::tools {

/// Big blocks go back to the system as soon as they are freed, so that the limit holds between
/// tiles too. To be called before a build.
void return_freed_memory(int threads);

/// Where the limit leaves room for it, freed blocks are kept for the next tile: giving them back and
/// taking fresh ones, page by page, is up to a sixth of the time of a build. To be called when the
/// plan of the build is known.
void keep_freed_memory(const BuildPlan& plan);

/// Gives back all that is kept, at once: where the next tile would not fit beside it.
void give_back_freed_memory();

}  // namespace ptin::tools
