// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the sources of the decoder share.
#pragma once

#include "engine/query/terrain.h"

#define PTIN_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace ptin::viewer {

/// The one reader of this instance.
[[nodiscard]] StreamReader& reader();

}  // namespace ptin::viewer
