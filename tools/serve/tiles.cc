// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles for viewers of the globe: quantized-mesh for Cesium, and 3D Tiles 1.1.
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "tools/formats/markup_text.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/serve/tile_number.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr std::string_view kQuantizedMesh = "application/vnd.quantized-mesh";

[[noreturn]] void throw_no_tile() {
  throw Problem(404,
                "there is no such tile; layer.json, tileset.json and its subtrees tell which "
                "ones there are");
}

/// What a viewer that assumes an ellipsoid has to know.
const char* datum_name(tools::VerticalDatum datum) {
  switch (datum) {
    case tools::VerticalDatum::kEllipsoidal:
      return "ellipsoidal";
    case tools::VerticalDatum::kOrthometric:
      return "orthometric: up to 110 m off the ellipsoid that viewers assume";
    case tools::VerticalDatum::kUnknown:
      break;
  }
  return "unknown";
}

std::shared_ptr<const tools::TerrainTiles> quantized(const Asked& asked) {
  return asked.collection->tile_sets.quantized(asked.terrain(), asked.collection->crs,
                                               asked.limits);
}

std::shared_ptr<const tools::TerrainTileset> tileset(const Asked& asked) {
  return asked.collection->tile_sets.tileset(asked.terrain(), asked.collection->crs, asked.limits);
}

/// The error is in metres, whatever the unit of the file's heights.
http::Response tile_response(const Asked& asked, tools::Tile tile, std::string_view media) {
  return answered(asked, std::move(tile.bytes), media, tile.cost, tile.error, false);
}

/// What a tileset tells people: 3D Tiles have no members of their own for it.
Json extras_of(const Credits& credits) {
  Json extras = Json::object();
  add_credits(extras, credits);
  if (credits.attribution.empty()) return extras;
  // Where Cesium looks for what it shows beside the picture.
  Json credit = {{"html", tools::markup_text(credits.attribution)}, {"showOnScreen", true}};
  extras["cesium"]["credits"] = Json::array({std::move(credit)});
  return extras;
}

http::Response layer_json(const Asked& asked) {
  Json json = quantized(asked)->layer_json(version_of(*asked.collection, asked.options.version));
  json["name"] = asked.collection->title();
  const std::string& attribution = asked.collection->credits.attribution;
  // Cesium shows it as HTML.
  if (!attribution.empty()) json["attribution"] = tools::markup_text(attribution);
  json["ptin:heights"] = datum_name(tools::vertical_datum(asked.collection->crs));
  return json_response(json);
}

}  // namespace

ask::Parameters tiles_parameters() {
  ask::Parameters rows;
  ask::add_text(rows, "v",
                "The version that layer.json tells: such an answer may be kept for ever");
  ask::add_text(rows, "extensions", "octvertexnormals, where the header Accept does not say so",
                "octvertexnormals");
  return rows;
}

http::Response answer_tiles(const Asked& asked) {
  if (asked.rest == "layer.json") return layer_json(asked);
  const std::optional<TileNumber> number = number_of_tile(asked.rest, ".terrain");
  if (!number) throw_no_tile();
  const std::string_view accept = asked.request.header("accept").value_or("");
  constexpr std::string_view kNormals = "octvertexnormals";
  const bool has_normals = accept.find(kNormals) != std::string_view::npos ||
                           asked.question.text("extensions").find(kNormals) != std::string::npos;
  std::optional<tools::Tile> tile =
      quantized(asked)->tile({number->level, number->x, number->y, has_normals, asked.limits});
  if (!tile) throw_no_tile();
  http::Response response = tile_response(asked, std::move(*tile), kQuantizedMesh);
  response.add("Vary", "Accept");
  return response;
}

http::Response answer_tileset(const Asked& asked) {
  Json json = tileset(asked)->tileset_json();
  if (Json extras = extras_of(asked.collection->credits); !extras.empty()) {
    json["asset"]["extras"] = std::move(extras);
  }
  return json_response(json);
}

http::Response answer_subtree(const Asked& asked) {
  const std::optional<TileNumber> number = number_of_tile(asked.rest, ".subtree");
  if (!number) throw_no_tile();
  std::optional<std::string> subtree = tileset(asked)->subtree(number->level, number->x, number->y);
  if (!subtree) throw_no_tile();
  return text_response(std::move(*subtree), "application/octet-stream");
}

http::Response answer_content(const Asked& asked) {
  const std::optional<TileNumber> number = number_of_tile(asked.rest, ".glb");
  if (!number) throw_no_tile();
  std::optional<tools::Tile> content =
      tileset(asked)->content(number->level, number->x, number->y, asked.limits);
  if (!content) throw_no_tile();
  return tile_response(asked, std::move(*content), "model/gltf-binary");
}

}  // namespace ptin::serve
