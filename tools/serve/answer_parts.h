// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the answers of the service have in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/query/questions.h"
#include "tools/ask/answer_facts.h"
#include "tools/http/response.h"
#include "tools/serve/endpoint.h"
#include "tools/serve/places.h"

namespace ptin::serve {

using ask::append_json_number;
using ask::Json;
using ask::LongText;
using ask::Told;

constexpr std::string_view kJson = "application/json";
constexpr std::string_view kGeoJson = "application/geo+json";
constexpr std::string_view kCoverageJson = "application/prs.coverage+json";
constexpr std::string_view kCsv = "text/csv; charset=utf-8";

/// The rows of a question; add_question() has them.
template <typename Values>
[[nodiscard]] ask::Parameters rows_of(Values& values) {
  ask::Parameters rows;
  add_question(rows, values);
  rows.keep(ask::Door::kService);
  return rows;
}
/// Reads the parameters of a question into what holds them.  @throws http::Problem 400
template <typename Values>
[[nodiscard]] Values read(const Asked& asked) {
  Values values;
  asked.question.read(rows_of(values));
  return values;
}
/// The same rows, to be described: they point at values that are gone.
template <typename Values>
[[nodiscard]] ask::Parameters described() {
  Values values;
  return rows_of(values);
}

/// The format that `f` names, or else the one that the header Accept likes best (of several the one
/// that it names most closely, then the first), or else the first.
/// @throws http::Problem 400  `f` names another one
[[nodiscard]] const ask::Format& format_of(const Asked& asked);
/// JSON as the text of an answer, and as the whole answer. Numbers that are not finite become null.
[[nodiscard]] std::string text_of(const Json& json);
[[nodiscard]] http::Response json_response(const Json& json, std::string_view media = kJson);
[[nodiscard]] http::Response text_response(std::string text, std::string_view media);

/// The text of an answer, within the half of the question's memory that its engine leaves
/// (engine_limits).
[[nodiscard]] ask::LongText long_text(const Asked& asked);
/// Memory that the answer takes for each position, vertex or elevation that it tells of, at most.
constexpr std::uint64_t kAnswerBytesOfPlace = 1536;
/// The memory that the engine has beside an answer of so many bytes, for which half is kept at most.
constexpr std::uint64_t engine_memory(std::uint64_t memory_bytes,
                                      std::uint64_t answer_bytes) noexcept {
  return memory_bytes - std::min(memory_bytes / 2, answer_bytes);
}
/// The limits of the engine beside an answer of so many bytes; without a number, with half of the memory.
[[nodiscard]] QueryLimits engine_limits(
    const Asked& asked, std::uint64_t answer_bytes = std::numeric_limits<std::uint64_t>::max());

/// The whole address of something of the collection, as "/dem/": clients that read it elsewhere need the
/// host, which is the public one, or else that of the request's header. Answers with such addresses are
/// called tilejson.json, and kept by host (TerrainService::key_of()).
[[nodiscard]] std::string address_of(const Asked& asked, std::string_view rest);

/// The answer with its headers: what it cost, as Server-Timing (time, pages, stars, records, bytes); how
/// certain it is, as Ptin-Certified-Error and Ptin-Exact; and whether the header Accept chose its format.
[[nodiscard]] http::Response answered(const Asked& asked, std::string text, std::string_view media,
                                      const QueryCost& cost, double certified_error, bool exact);
/// The same of what is drawn alone, and certified by nobody.
[[nodiscard]] http::Response drawn(const Asked& asked, std::string text, std::string_view media,
                                   const QueryCost& cost);
template <typename Result>
[[nodiscard]] http::Response answered(const Asked& asked, std::string text, std::string_view media,
                                      const Result& result) {
  return answered(asked, std::move(text), media, result.cost, result.certified_error, result.exact);
}

/// The object that every answer in JSON has beside these headers.
[[nodiscard]] Json certainty_json(const Asked& asked, double certified_error,
                                  double certified_deviation, bool exact);
template <typename Result>
[[nodiscard]] Json certainty_of(const Asked& asked, const Result& result) {
  return certainty_json(asked, result.certified_error, result.certified_deviation, result.exact);
}

/// What the service tells of a row as an object, as a line of a table, as a feature.
constexpr Told kObject = Told::kService & Told::kObject,
               kTableRow = Told::kService & Told::kTableRow,
               kFeature = Told::kService & Told::kFeature;
/// Rows as CSV.
/// @param rows    How many there are.
/// @param row_at  Makes one by its number.
template <typename Row, typename RowAt>
[[nodiscard]] std::string csv_text(const Asked& asked, const ask::Fields<Row>& fields,
                                   std::size_t rows, const RowAt& row_at) {
  LongText text = long_text(asked);
  ask::add_csv(text, fields.told(kTableRow), rows, row_at);
  return text.take();
}
/// Adds the members of an object, and ends the answer.
[[nodiscard]] std::string ended(LongText& text, const Json& members);
/// Rows as the array "points" of an object.
/// @param more  Its other members.
template <typename Row, typename RowAt>
[[nodiscard]] std::string points_text(const Asked& asked, const ask::Fields<Row>& all,
                                      std::size_t rows, const RowAt& row_at, const Json& more) {
  const ask::Fields<Row> fields = all.told(kObject);
  LongText text = long_text(asked);
  text.add("{\"points\":[");
  for (std::size_t i = 0; i < rows; ++i) {
    ask::add_object(i == 0 ? text : text.add(","), fields, fields.values_of(row_at(i)));
  }
  return ended(text.add("]"), more);
}
/// Rows as features of GeoJSON.
/// @param add_geometry  Adds the geometry of a row by its number, before its properties.
/// @param more          Members of the collection.
template <typename Row, typename RowAt, typename AddGeometry>
[[nodiscard]] std::string features_text(const Asked& asked, const ask::Fields<Row>& all,
                                        std::size_t rows, const RowAt& row_at,
                                        const AddGeometry& add_geometry, const Json& more) {
  const ask::Fields<Row> fields = all.told(kFeature);
  LongText text = long_text(asked);
  text.add(R"({"type":"FeatureCollection","features":[)");
  for (std::size_t i = 0; i < rows; ++i) {
    text.add(i == 0 ? "" : ",\n").add(R"({"type":"Feature","geometry":)");
    add_geometry(text, i);
    text.add(",\"properties\":");
    ask::add_object(text, fields, fields.values_of(row_at(i)));
    text.add("}");
  }
  return ended(text.add("]"), more);
}
/// The object of GeoJSON that stands for a position: {"type":"Point","coordinates":[x,y]}.
void add_point(LongText& text, const MapPoint& p);
/// The object of a position in map units, in the CRS of the client.
void add_point(LongText& text, MapPoint p, const Places& places);
void add_pair(LongText& text, const MapPoint& p);

/// Positions of the client in the CRS that `crs` names.
[[nodiscard]] Places places_of(const Asked& asked);

/// @throws http::Problem 400  fewer vertices than the coarsest TIN has
void check_detail(const Asked& asked, const DetailRequest& detail);

/// The window of the parameter `bbox` in map units; none where it was not given.
/// @throws http::Problem 400  it misses the terrain (tells the bounds in the CRS of the client)
[[nodiscard]] std::optional<Window> window_on_terrain(const Asked& asked, const Places& places,
                                                      const std::optional<Window>& bbox);

/// @throws http::Problem 413  more than the limit `name` allows
void check_count(std::size_t count, std::size_t most, std::string_view what, std::string_view name,
                 std::string_view parameter);

}  // namespace ptin::serve
