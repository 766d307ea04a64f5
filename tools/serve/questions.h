// SPDX-License-Identifier: GPL-3.0-or-later
//
// What answers the questions about a collection: one file a question, each of this form. The table
// that brings them together is in endpoints.cc.
#pragma once

#include <span>

#include "tools/http/response.h"
#include "tools/serve/endpoint.h"

namespace ptin::serve {

/// @throws http::Problem, Error
using Answer = http::Response(const Asked& asked);

Answer answer_position, answer_trajectory, answer_area, answer_elevation, answer_mesh,
    answer_isolines, answer_highest, answer_viewshed, answer_profile, answer_sight, answer_stream,
    answer_file, answer_tiles, answer_tileset, answer_subtree, answer_content;
/// As clients of Google's Elevation API and of opentopodata expect a refusal.
void refuse_elevation(http::Response& refusal);
Answer answer_viewer, answer_landing, answer_conformance, answer_api, answer_collections,
    answer_collection;

// What they take. A page: what is about the service itself, but for the landing page.
[[nodiscard]] std::span<const ParameterFact> landing_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> page_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> viewer_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> position_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> trajectory_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> area_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> elevation_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> mesh_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> isolines_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> highest_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> viewshed_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> profile_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> sight_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> stream_parameters() noexcept;
[[nodiscard]] std::span<const ParameterFact> tiles_parameters() noexcept;

}  // namespace ptin::serve
