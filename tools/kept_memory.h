// SPDX-License-Identifier: GPL-3.0-or-later
//
// The allocator's treatment of freed memory: what a build keeps for its next tile, and a service for its
// next question.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/construct/build_plan.h"

namespace ptin::tools {

/// Big blocks go back to the system as soon as they are freed, so that the limit holds between
/// tiles too. To be called before a build.
void return_freed_memory(int threads);

/// Where the limit leaves room for it, freed blocks are kept for the next tile: giving them back and
/// taking fresh ones, page by page, is up to a sixth of the time of a build. To be called when the
/// plan of the build is known.
void keep_freed_memory(const BuildPlan& plan);

/// Freed blocks are kept for the next question: a large one would else take some thousand fresh pages
/// one by one. To be called before a service has threads, once.
/// @param kept  Bytes. Blocks larger than half of it go back as soon as they are freed.
/// @return  What gives all back where more than `kept` is free and resident. To be called when questions
///          have ended, on any thread. Cost: some microseconds, and where it gives back, the next
///          questions' fresh pages.
[[nodiscard]] std::function<void()> keep_freed_memory_of_questions(std::uint64_t kept);

/// Gives back all that is kept, at once: where the next tile would not fit beside it, or nothing is
/// left to do.
void give_back_freed_memory();

}  // namespace ptin::tools
