// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cut and fill against a height, or against another collection.
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/crs/ground.h"
#include "engine/number.h"
#include "tools/ask/questions.h"
#include "tools/ask/volume_terms.h"
#include "tools/http/problem.h"
#include "tools/region/straight_sides.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

using http::Problem;

struct VolumeAsked {
  ask::RegionText region;
  DetailRequest detail;
};

void add_question(ask::Parameters& rows, VolumeAsked& question) {
  ask::add_text(
      rows, "against",
      "A height, in the terrain's unit, or the name of another collection of the same CRS; "
      "cut is what lies above it",
      "100")
      .required_at(ask::Door::kService);
  ask::add_text(rows, "coords", "The region as WKT, POLYGON or MULTIPOLYGON, instead of bbox",
                "POLYGON((-118.31 34.34, -118.3 34.34, -118.3 34.35, -118.31 34.34))")
      .excluding("bbox");
  ask::add_window(rows, question.region, ask::Door::kService);
  ask::add_detail(
      rows, question.detail, ", of either terrain; volumes come with intervals",
      "The TINs of the N most important vertices, instead of an error; volumes come with "
      "intervals",
      ask::Door::kService);
  ask::add_crs(rows);
}

/// The polygon of `coords` in the terrain's CRS, its sides straight in the client's.
Polygon polygon_there(const Asked& asked, const Places& places) {
  Polygon polygon = polygon_of_wkt(asked.question.text("coords"), "coords");
  std::size_t corners = 0;
  for (const auto& ring : polygon.rings) corners += ring.size();
  check_count(corners, asked.options.question.points, "positions", "points", "coords");
  tools::SideTarget sides = tools::side_target(asked.facts(), 0.0);
  sides.most_points = asked.options.question.vertices;
  for (auto& ring : polygon.rings) {
    ring.push_back(ring.front());
    auto lines = places.line_to_terrain(std::move(ring), sides);
    if (lines.size() != 1) {
      throw Problem(
          400,
          "a polygon crosses the longitude at which this terrain begins and ends; ask for "
          "one on each side of it")
          .at("coords");
    }
    ring = std::move(lines.front());
    ring.pop_back();
  }
  return polygon;
}

/// The other collection, and one of its heights' units in the terrain's.
struct Other {
  std::shared_ptr<const Collection> collection;
  double height_scale = 1.0;
};

/// @throws Problem 400, 404
Other other_of(const Asked& asked, const std::string& name) {
  Other other{asked.catalogue.find(name)};
  if (!other.collection) {
    throw Problem(404,
                  "\"" + name +
                      "\" is neither a height nor the name of a collection; /collections lists "
                      "them")
        .at("against");
  }
  const CrsFacts &here = asked.collection->crs, &there = other.collection->crs;
  const std::string mismatch = ask::mismatch_of(here, there, asked.collection->id);
  if (!mismatch.empty()) throw Problem(400, name + ": " + mismatch).at("against");
  const std::optional<double> scale = ask::height_scale(here, there);
  if (!scale &&
      (here.vertical_unit != there.vertical_unit || here.wkt.empty() != there.wkt.empty())) {
    throw Problem(400,
                  "nothing tells the unit of the heights of one of the two terrains, so they "
                  "cannot be compared; state it with build --vertical-crs")
        .at("against");
  }
  other.height_scale = scale.value_or(1.0);
  return other;
}

}  // namespace

ask::Parameters volume_parameters() { return described<VolumeAsked>(); }

http::Response answer_volume(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  const auto question = read<VolumeAsked>(asked);
  check_detail(asked, question.detail);
  const Places places = places_of(asked);
  VolumeRequest request;
  request.detail = question.detail;
  ask::set_ground(request, asked.collection->crs);
  request.limits = asked.limits;
  if (asked.question.has("coords")) {
    request.region = polygon_there(asked, places);
  } else if (const auto window = window_on_terrain(asked, places, question.region.window)) {
    request.region = *window;
  }
  const std::string& against = asked.question.text("against");
  const std::optional<double> level = parse_number<double>(against);
  Other other;
  if (level && std::isfinite(*level)) {
    request.level = *level;
  } else {
    other = other_of(asked, against);
    request.other = &other.collection->terrain;
    request.other_height_scale = other.height_scale;
  }
  const std::vector<VolumeResult> results =
      asked.terrain().volumes(request, std::array{request.level});
  const VolumeResult& result = results.front();
  ask::VolumeAnswer answer;
  answer.ground_unit = unit_of_ground(asked.collection->crs);
  answer.rows.push_back({&result, other.collection ? std::nullopt : level});
  if (other.collection) {
    answer.against = against;
    answer.other_facts = ask::facts_of(result.other_certificate, result.exact,
                                       other.collection->terrain.store(), other.collection->crs);
  }
  const Certificate& certainty = result.certificate;
  Json json = certainty_json(asked, certainty.error, certainty.deviation, result.exact);
  json.update(ask::volume_fields().told(kObject).object_of(answer));
  return answered(asked, text_of(json), format.media, result.cost, certainty.error, result.exact);
}

}  // namespace ptin::serve
