// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the answers of the service have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tools/http/response.h"
#include "tools/serve/endpoint.h"
#include "tools/serve/places.h"

namespace ptin::serve {

using Json = nlohmann::ordered_json;

constexpr std::string_view kJson = "application/json";
constexpr std::string_view kGeoJson = "application/geo+json";
constexpr std::string_view kCoverageJson = "application/prs.coverage+json";
constexpr std::string_view kCsv = "text/csv; charset=utf-8";

/// A format that a question offers, as `f` names it.
struct OfferedFormat {
  std::string_view name;
  std::string_view media;
};

/// The format that `f` names, or else the one that the header Accept likes best (of several the one
/// that it names most closely, then the first), or else the first.
/// @throws http::Problem 400  `f` names another one
[[nodiscard]] const OfferedFormat& format_of(const Asked& asked,
                                             std::span<const OfferedFormat> offered);
/// Tells caches that the header Accept chose the format of an answer, where it did.
void add_choice(http::Response& response, const Asked& asked);

/// A body of JSON. Numbers that are not finite become null.
[[nodiscard]] http::Response json_response(const Json& json, std::string_view media = kJson);
[[nodiscard]] http::Response text_response(std::string text, std::string_view media);

/// The text of an answer that may be long, written piece by piece within the half of the question's
/// memory that its engine leaves (engine_limits). Every piece looks whether the client is still there.
class LongText {
 public:
  explicit LongText(const Asked& asked)
      : most_bytes_(asked.limits.memory_bytes / 2), stop_(asked.limits.stop) {}

  // All throw Error resource_exhausted beyond the memory, and cancelled.
  LongText& add(std::string_view text);
  /// As few digits as read back to the same double; null where it is not finite.
  LongText& number(double value);
  LongText& truth(bool value) { return add(value ? "true" : "false"); }
  LongText& json(const Json& value);

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  void make_room(std::size_t bytes);

  std::string text_;
  std::size_t most_bytes_;
  std::size_t next_look_ = 0;  ///< At so many bytes the stop token is asked again.
  std::stop_token stop_;
};
/// Memory that the answer takes for each position, vertex or elevation that it tells of, at most.
constexpr std::uint64_t kAnswerBytesOfPlace = 1536;
/// The limits of the engine beside an answer of so many bytes, for which half of the memory is kept at
/// most; without a number, half.
[[nodiscard]] QueryLimits engine_limits(
    const Asked& asked, std::uint64_t answer_bytes = std::numeric_limits<std::uint64_t>::max());

/// Adds what an answer cost, as Server-Timing: time, pages, stars, records, bytes.
void add_cost(http::Response& response, const QueryCost& cost);
/// Adds how certain it is: Ptin-Certified-Error, Ptin-Exact.
void add_certainty(http::Response& response, double certified_error, bool exact);

/// The object that every answer in JSON has beside these headers.
[[nodiscard]] Json certainty_json(const Asked& asked, double certified_error,
                                  double certified_deviation, bool exact);

/// The level of detail that is asked for.
/// @throws http::Problem 400  as Question::detail(); fewer vertices than the coarsest TIN has
[[nodiscard]] DetailRequest detail_of(const Asked& asked);

/// The window of the parameter `bbox`, map units; none where it was not given.
/// @throws http::Problem 400  it misses the terrain (tells the bounds in the CRS of the client)
[[nodiscard]] std::optional<Window> window_on_terrain(const Asked& asked, const Places& places);

/// @throws http::Problem 413  more than the limit `name` allows
void check_count(std::size_t count, std::size_t most, std::string_view what, std::string_view name,
                 std::string_view parameter);

/// A number as few digits as read back to the same double; null where it is not finite.
void append_json_number(std::string& text, double value);

// Parameters that many questions take.
constexpr ParameterFact kCrsParameter{
    "crs", "string",
    "CRS of positions that come and go: CRS84 (longitude, latitude; without it), native, or an "
    "EPSG code or OGC URI",
    "CRS84"};
constexpr ParameterFact kErrorParameter{
    "error", "number",
    "certified error allowed, in the unit of the heights; without it: full detail", "5"};
constexpr ParameterFact kVerticesParameter{
    "vertices", "integer", "the TIN of the so many most important vertices, instead of an error"};
constexpr ParameterFact kBboxParameter{
    "bbox", "array", "west, south, east, north; across the antimeridian west is larger than east",
    "-118.31,34.34,-118.3,34.35"};
constexpr ParameterFact kDatetimeParameter{"datetime", "string",
                                           "accepted and without effect: a terrain has no time"};
constexpr ParameterFact kZParameter{
    "z", "string", "accepted and without effect: a surface has one height at a position"};
constexpr ParameterFact kNamesParameter{"parameter-name", "string",
                                        "height, height_min, height_max, state, or several between "
                                        "commas; all without it. CoverageJSON "
                                        "holds these alone, other formats all",
                                        "height,state"};

}  // namespace ptin::serve
