// SPDX-License-Identifier: GPL-3.0-or-later
//
// The means that both modules (decoder.cc, questions.cc) have to talk to their host: exported functions, refusals, and what
// both hold of a terrain.
//
// Errors: these builds have no exceptions to catch, so `throw` ends in __cxa_throw() (module.cc). That hands code and text to
// the host, whose function throws in its own language and so leaves the module for good.
#pragma once

#include <type_traits>

#include "engine/mesh/tin.h"
#include "storage/store_facts.h"

#define PTIN_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace ptin::viewer {

/// The mesh that the module holds and exports (module.cc), as engine/mesh/tin.h has it in memory.
[[nodiscard]] const Tin& tin();

/// The facts of its terrain. src/questions.ts copies those of the decoder, byte by byte: one compiler lays both out.
[[nodiscard]] const StoreFacts& facts();
static_assert(std::is_trivially_copyable_v<StoreFacts>);

}  // namespace ptin::viewer
