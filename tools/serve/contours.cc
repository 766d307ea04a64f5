// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contours as vector tiles of web maps, and their TileJSON.
#include <optional>
#include <string>
#include <utility>

#include "engine/error.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/serve/tile_number.h"
#include "tools/tiles/contour_tiles.h"

namespace ptin::serve {

namespace {

struct ContoursQuestion {
  std::string version;
  std::optional<double> interval;
};

void add_question(ask::Parameters& rows, ContoursQuestion& question) {
  rows.add("interval", &question.interval, "METRES",
           "Metres between levels, of every zoom (default: by zoom, as tilejson.json tells)")
      .within(NumberRange::kPositive)
      .like("25");
  rows.add("v", &question.version, "TEXT",
           "The version that tilejson.json tells: such an answer may be kept for ever");
}

http::Response contours_tilejson(const Asked& asked, const tools::MercatorPyramid& pyramid,
                                 std::optional<double> interval) {
  Json json = tools::contour_facts(pyramid, interval);
  json["tilejson"] = "3.0.0";
  json["scheme"] = "xyz";
  json["name"] = asked.collection->id;
  json["ptin:heights"] = asked.collection->crs.vertical_text();
  const std::string& given = asked.question.text("interval");
  json["tiles"] = {address_of(asked, "/contours/{z}/{x}/{y}.mvt?") +
                   (given.empty() ? "" : "interval=" + Json(*interval).dump() + "&") +
                   "v=" + version_of(*asked.collection, asked.options.version)};
  return json_response(json);
}

/// The result of make(), whose refusal of an interval names the parameter.
template <typename Make>
auto with_interval(const Make& make) {
  try {
    return make();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw http::Problem(400, error.message()).at("interval");
  }
}

}  // namespace

ask::Parameters contours_parameters() { return described<ContoursQuestion>(); }

http::Response answer_contours(const Asked& asked) {
  const auto question = read<ContoursQuestion>(asked);
  const std::shared_ptr<const tools::MercatorPyramid> pyramid =
      asked.collection->tile_sets.mercator(asked.terrain(), asked.collection->crs, asked.limits);
  if (asked.rest == "tilejson.json") {
    return with_interval([&] { return contours_tilejson(asked, *pyramid, question.interval); });
  }
  const std::optional<TileNumber> number =
      number_of_tile(asked.rest, asked.rest.ends_with(".pbf") ? ".pbf" : ".mvt");
  if (number && number->level <= last_contour_zoom(*pyramid)) {
    std::optional<tools::ContourTile> tile = with_interval([&] {
      return tools::contour_tile(*pyramid, {static_cast<int>(number->level), number->x, number->y},
                                 question.interval, asked.limits);
    });
    if (tile) {
      return drawn(asked, std::move(tile->bytes), "application/vnd.mapbox-vector-tile", tile->cost);
    }
  }
  throw http::Problem(404, "there is no such tile; tilejson.json tells zooms and bounds");
}

}  // namespace ptin::serve
