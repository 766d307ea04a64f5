// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights as colours of tiles of web maps, and their TileJSON.
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/error.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/serve/tile_number.h"
#include "tools/tiles/height_tiles.h"

namespace ptin::serve {

namespace {

using http::Problem;
using tools::HeightCode;
using tools::TileFormat;

struct DemQuestion {
  std::string version, encoding = "mapbox", size = "256", voids = "transparent", format = "png";
};

void add_question(ask::Parameters& rows, DemQuestion& question) {
  rows.add("encoding", &question.encoding, "NAME", "How three bytes hold a height")
      .of({"mapbox", "terrarium"})
      .with_default();
  rows.add("size", &question.size, "PIXELS", "Pixels along a side of a tile")
      .of({"256", "512"})
      .with_default();
  rows.add("voids", &question.voids, "HOW",
           "Pixels without surface have the colour of 0 m: transparent, or opaque")
      .of({"transparent", "fill"})
      .with_default();
  rows.add("format", &question.format, "NAME", "Of the tiles that tilejson.json tells of")
      .of({"png", "webp"})
      .with_default();
  rows.add("v", &question.version, "TEXT",
           "The version that tilejson.json tells: such an answer may be kept for ever");
}

tools::HeightTileStyle style_of(const DemQuestion& question, std::string_view format) {
  tools::HeightTileStyle style;
  style.code = question.encoding == "terrarium" ? HeightCode::kTerrarium : HeightCode::kMapbox;
  style.format = format == "webp" ? TileFormat::kWebp : TileFormat::kPng;
  style.side = question.size == "512" ? 512 : 256;
  style.fills_voids = question.voids == "fill";
  return style;
}

/// What the encoding does not hold is a fault of the parameter.
void check_encoding(const tools::MercatorPyramid& pyramid, HeightCode code) {
  try {
    tools::check_heights(pyramid, code);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw Problem(400, error.message()).at("encoding");
  }
}

/// The query of a tile's address.
std::string query_of(const tools::HeightTileStyle& style, const std::string& version) {
  return "?encoding=" + std::string(name_of(style.code)) + "&size=" + std::to_string(style.side) +
         "&voids=" + (style.fills_voids ? "fill" : "transparent") + "&v=" + version;
}

http::Response dem_tilejson(const Asked& asked, const tools::MercatorPyramid& pyramid,
                            const tools::HeightTileStyle& style) {
  Json json = tools::height_facts(pyramid, style);
  json["tilejson"] = "2.2.0";  // From 3.0.0 on there are vector layers.
  json["scheme"] = "xyz";
  json["name"] = asked.collection->id;
  json["tileSize"] = style.side;  // As MapLibre reads it.
  json["ptin:heights"] = asked.collection->crs.vertical_text();
  json["tiles"] = {address_of(asked, "/dem/{z}/{x}/{y}.") + std::string(name_of(style.format)) +
                   query_of(style, version_of(*asked.collection, asked.options.version))};
  return json_response(json);
}

}  // namespace

ask::Parameters dem_parameters() { return described<DemQuestion>(); }

http::Response answer_dem(const Asked& asked) {
  const auto question = read<DemQuestion>(asked);
  const std::shared_ptr<const tools::MercatorPyramid> pyramid =
      asked.collection->tile_sets.mercator(asked.terrain(), asked.collection->crs, asked.limits);
  if (asked.rest == "tilejson.json") {
    const tools::HeightTileStyle style = style_of(question, question.format);
    check_encoding(*pyramid, style.code);
    return dem_tilejson(asked, *pyramid, style);
  }
  const bool is_webp = asked.rest.ends_with(".webp");
  const tools::HeightTileStyle style = style_of(question, is_webp ? "webp" : "png");
  const std::optional<TileNumber> number = number_of_tile(asked.rest, is_webp ? ".webp" : ".png");
  if (number && number->level <= last_zoom(*pyramid, style)) {
    check_encoding(*pyramid, style.code);
    std::optional<tools::Tile> tile = tools::height_tile(
        *pyramid, style, {static_cast<int>(number->level), number->x, number->y}, asked.limits);
    if (tile) {
      return answered(asked, std::move(tile->bytes), media_of(style.format), tile->cost,
                      tile->error, false);
    }
  }
  throw Problem(404, "there is no such tile; tilejson.json tells zooms and bounds");
}

}  // namespace ptin::serve
