// SPDX-License-Identifier: GPL-3.0-or-later
//
// One sweep over a mesh around an eye, front to back.
#pragma once

#include <cstdint>

#include "engine/mesh/tin.h"
#include "engine/query/sight/viewshed.h"
#include "storage/store_file.h"

namespace ptin {

/// How a sweep treats what it does not know: the full surface is as high as it may be before a
/// target, and as low as it may be below it; or the other way round.
struct SightBias {
  double sign = 0;     ///< 1: before a target higher; -1: lower; 0: as it is.
  double slope = 0;    ///< What is not known, per ground unit of distance.
  bool voids = false;  ///< Void triangles may be ground of any height.
  double base = 0;     ///< What is not known besides, at any distance.
};

struct HeldBySweeps {
  std::uint64_t mesh_bytes = 0;
  std::uint64_t results = 1;  ///< Of sweeps at once, that of the one to come included.
};

/// What the eye sees of `tin`; of the result, certificates and cost are left out. Every target is
/// told visible or hidden.
/// @param held  What the caller holds beside: it counts against the memory limit.
/// @throws Error invalid_argument    as find_eye() (viewshed_eye.h)
///               resource_exhausted, cancelled
[[nodiscard]] Viewshed sweep_viewshed(const Tin& tin, const StoreFacts& facts,
                                      const ViewshedRequest& request, const QueryContext& context,
                                      const SightBias& bias, const HeldBySweeps& held);

}  // namespace ptin
