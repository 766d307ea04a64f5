// SPDX-License-Identifier: GPL-3.0-or-later
//
// Point location at a level of detail that was found before: for questions that locate several
// times.
#pragma once

#include "engine/query/heights/locate.h"
#include "engine/query/select/detail.h"

namespace ptin {

/// As locate() (locate.h).
/// @param detail  That of the request's tolerance and vertices.
[[nodiscard]] LocateResult locate_at(const ProgressiveTin& terrain,
                                     std::span<const MapPoint> points, const LocateRequest& request,
                                     const Detail& detail);

}  // namespace ptin
