// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions of a mesh that was received: heights, profiles and lines of sight over the mesh as it
// is, within its certificate. The file from which it came is not at hand.
#pragma once

#include <functional>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/heights/locate.h"
#include "engine/query/heights/profile.h"
#include "engine/query/select/certificate.h"
#include "engine/query/sight/sight.h"
#include "storage/store_facts.h"

namespace ptin {

/// A mesh, and what is known of it. Both are borrowed.
struct ReceivedMesh {
  const Tin& tin;
  /// `free_of_voids` as the metadata of the stream state it.
  const StoreFacts& facts;
  /// The bounds at the places that are asked. `complete`: no record of the file is missing there.
  Certificate certificate;
};

/// The certificate where nothing better is known of a mesh: full TIN and mesh lie between the least
/// and the greatest height of the terrain.
[[nodiscard]] Certificate certificate_by_relief(const StoreFacts& facts);

/// The point of the mesh at a map position. Its interval is that of the certificate.
/// @throws Error invalid_argument  a coordinate that is not finite
/// Cost: about the square root of the number of triangles.
[[nodiscard]] LocatedPoint locate_on(const ReceivedMesh& mesh, MapPoint at);

/// The points of a straight line over the mesh, as profile() has them of a file.
/// @param ground_distance  As ProfileRequest::ground_distance.
/// @throws Error invalid_argument    as profile()
///               resource_exhausted  the line crosses more than `memory_bytes` hold
/// Cost: the number of triangles of the mesh.
[[nodiscard]] std::vector<ProfilePoint> profile_on(
    const ReceivedMesh& mesh, MapPoint from, MapPoint to,
    const std::function<double(MapPoint, MapPoint)>& ground_distance, std::uint64_t memory_bytes);

/// Whether one end sees the other. The verdict is certain, or it is undecided: what the mesh leaves
/// out counts below both ends, too, and so do voids that may be there.
/// @param request  Heights, curvature, distance and wavelength count; detail, budget and limits do
///                 not.
/// @throws Error invalid_argument  as SightSolver::solve(); both ends at one place
/// Cost: the triangles on the way.
[[nodiscard]] SightResult sight_on(const ReceivedMesh& mesh, const SightPair& pair,
                                   const SightRequest& request);

}  // namespace ptin
