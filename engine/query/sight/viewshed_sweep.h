// SPDX-License-Identifier: GPL-3.0-or-later
//
// One sweep over a mesh around an eye, front to back.
#pragma once

#include <cstdint>

#include "engine/mesh/tin.h"
#include "engine/query/sight/viewshed.h"
#include "storage/store_file.h"

namespace ptin {

/// How a sweep treats what it does not know of the full surface. With sign 1 the surface is as high
/// as it may be before a target, and as low as it may be below the target: what is visible then is
/// certainly visible. With sign -1 it is the other way round: what is hidden then is certainly
/// hidden. With sign 0 the surface is taken as it is.
struct SightBias {
  double sign = 0;  ///< 1, -1 or 0, as above.
  /// Most that the surface may be off, per ground unit of distance from the eye.
  double slope = 0;
  bool voids = false;  ///< Void triangles may hold ground of any height of the terrain.
  double base = 0;  ///< Most that the surface may be off besides, at any distance, height's unit.
};

/// What the caller of a sweep holds in memory.
struct HeldBySweeps {
  std::uint64_t mesh_bytes = 0;
  std::uint64_t results = 1;  ///< Results at once, that of the coming sweep included.
};

/// One sweep: what the eye sees of `tin`. Every target of the result is visible or hidden; the
/// caller fills in certificates and cost.
/// @param held  Counts against the memory limit.
/// @throws Error invalid_argument    as find_eye() (sight/viewshed_eye.h)
///               resource_exhausted, cancelled
[[nodiscard]] Viewshed sweep_viewshed(const Tin& tin, const StoreFacts& facts,
                                      const ViewshedRequest& request, const QueryContext& context,
                                      const SightBias& bias, const HeldBySweeps& held);

}  // namespace ptin
