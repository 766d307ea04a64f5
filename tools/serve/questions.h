// SPDX-License-Identifier: GPL-3.0-or-later
//
// What answers the questions about a collection: one file a question, each of this form. The table
// that brings them together is in endpoints.cc.
#pragma once

#include <span>

#include "tools/ask/long_text.h"
#include "tools/http/response.h"
#include "tools/serve/endpoint.h"

namespace ptin::serve {

/// @throws http::Problem, Error
using Answer = http::Response(const Asked& asked);

Answer answer_position, answer_trajectory, answer_area, answer_cube, answer_radius, answer_corridor,
    answer_elevation, answer_google_elevation, answer_lookup, answer_mesh, answer_isolines,
    answer_highest, answer_viewshed, answer_profile, answer_sight, answer_volume, answer_stream,
    answer_file, answer_raster, answer_schema, answer_tiles, answer_tileset, answer_subtree,
    answer_content, answer_dem, answer_contours;
/// As clients of Google's Elevation API and of opentopodata expect a refusal.
void refuse_elevation(http::Response& refusal);
Answer answer_viewer, answer_landing, answer_conformance, answer_api, answer_collections,
    answer_collection, answer_style, answer_thumbnail;

/// The most vertices that a receiver may have for a stream to go on: `held_vertices`, or as many as
/// `question_memory` holds beside an answer of `stream_bytes`.
[[nodiscard]] std::uint64_t most_held_vertices(const QuestionLimits& limits);

/// A service of these questions as OpenAPI 3.0.
/// @param base  As of http::Request.
[[nodiscard]] ask::Json openapi(std::span<const Endpoint> all, const ServeOptions& options,
                                const std::string& base = {});

// The parameters that they take, as rows that describe them, but for `f`.
[[nodiscard]] ask::Parameters viewer_parameters();
[[nodiscard]] ask::Parameters area_parameters();
[[nodiscard]] ask::Parameters cube_parameters();
[[nodiscard]] ask::Parameters radius_parameters();
[[nodiscard]] ask::Parameters corridor_parameters();
[[nodiscard]] ask::Parameters elevation_parameters();
[[nodiscard]] ask::Parameters lookup_parameters();
[[nodiscard]] ask::Parameters mesh_parameters();
[[nodiscard]] ask::Parameters raster_parameters();
[[nodiscard]] ask::Parameters stream_parameters();
[[nodiscard]] ask::Parameters thumbnail_parameters();
[[nodiscard]] ask::Parameters tiles_parameters();
[[nodiscard]] ask::Parameters volume_parameters();
[[nodiscard]] ask::Parameters dem_parameters();
[[nodiscard]] ask::Parameters contours_parameters();

}  // namespace ptin::serve
