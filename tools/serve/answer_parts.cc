// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/answer_parts.h"

#include <algorithm>
#include <cmath>

#include "engine/number.h"
#include "engine/web_address.h"
#include "tools/http/forwarded.h"
#include "tools/http/list_header.h"
#include "tools/http/problem.h"
#include "tools/output/file_name.h"

namespace ptin::serve {

namespace {

/// How much a client likes a media type, and how closely it names it: 3 by its name, 2 by "text/*",
/// 1 by "*/*", 0 not at all.
struct Liking {
  double quality = 0.0;
  int closeness = 0;
};

/// What the header Accept, in lower case, says of a media type: the range counts that is closest.
Liking named_liking_of(std::string_view accept, std::string_view media) {
  Liking liking;
  for (const std::string_view range : ask::parts_of(accept, ',')) {
    const std::vector<std::string_view> parts = ask::parts_of(range, ';');
    const std::string_view name = parts.empty() ? "" : ask::trimmed(parts[0]);
    const bool is_of_kind =
        name.ends_with("/*") && media.starts_with(name.substr(0, name.size() - 1));
    const int closeness = name == media ? 3 : name == "*/*" ? 1 : is_of_kind ? 2 : 0;
    if (closeness <= liking.closeness) continue;
    liking = {1.0, closeness};
    for (std::string_view parameter : parts) {
      parameter = ask::trimmed(parameter);
      if (parameter.starts_with("q="))
        liking.quality = parse_number<double>(parameter.substr(2)).value_or(0.0);
    }
  }
  return liking;
}

/// Liking where application/json stands for all that is JSON: libraries send it with every
/// request, and it chooses between kinds of JSON only for a client that takes nothing else.
Liking liking_of(std::string_view accept, std::string_view media) {
  media = media.substr(0, media.find(';'));
  Liking liking = named_liking_of(accept, media);
  const bool is_kind_of_json = media.ends_with("+json") && liking.closeness < 2;
  if (!is_kind_of_json && media != kJson) return liking;
  const Liking json = named_liking_of(accept, kJson);
  const bool takes_anything = named_liking_of(accept, "*/*").quality > 0;
  if (is_kind_of_json && json.closeness == 3) {
    liking.quality = std::max(liking.quality, json.quality);
  }
  return {liking.quality, takes_anything ? 1 : liking.closeness};
}

/// Adds what an answer cost, as Server-Timing.
void add_cost(http::Response& response, const QueryCost& cost) {
  std::string value = "query;dur=";
  append_json_number(value, std::round(1e5 * cost.seconds) / 1e2);
  value += ";desc=\"pages=" + std::to_string(cost.io.pages) +
           " stars=" + std::to_string(cost.stars_read) +
           " samples=" + std::to_string(cost.samples_read) +
           " records=" + std::to_string(cost.records_retrieved) +
           " bytes=" + std::to_string(cost.io.bytes_read);
  if (cost.io.remote_rounds > 0) {
    value += " remote_rounds=" + std::to_string(cost.io.remote_rounds) +
             " remote_requests=" + std::to_string(cost.io.remote_requests) +
             " remote_bytes=" + std::to_string(cost.io.remote_bytes);
  }
  value += "\"";
  response.add("Server-Timing", std::move(value));
}

}  // namespace

const ask::Format& format_of(const Asked& asked) {
  if (!asked.question.text("f").empty()) {
    std::string chosen;
    ask::Parameters rows;
    ask::add_format(rows, chosen, asked.formats);
    asked.question.read(rows);
    for (const ask::Format& format : asked.formats) {
      if (format.name == chosen) return format;
    }
  }
  const std::string accept = tools::lower_case(http::list_of(asked.request, "accept"));
  const ask::Format* best = &asked.formats.front();
  Liking most;
  for (const ask::Format& format : asked.formats) {
    const Liking liking = liking_of(accept, format.media);
    const bool is_liked_more =
        liking.quality > most.quality ||
        (liking.quality == most.quality && liking.quality > 0 && liking.closeness > most.closeness);
    if (!is_liked_more) continue;
    most = liking;
    best = &format;
  }
  return *best;
}

ask::LongText long_text(const Asked& asked) {
  return LongText(asked.limits.memory_bytes / 2, asked.limits.stop);
}

QueryLimits engine_limits(const Asked& asked, std::uint64_t answer_bytes) {
  QueryLimits limits = asked.limits;
  limits.memory_bytes = engine_memory(limits.memory_bytes, answer_bytes);
  return limits;
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

http::Response json_response(const Json& json, std::string_view media) {
  return text_response(text_of(json), media);
}

http::Response text_response(std::string text, std::string_view media) {
  http::Response response;
  response.content_type = media;
  response.body = std::move(text);
  return response;
}

std::string address_of(const Asked& asked, std::string_view rest) {
  const std::string path = "/collections/" + asked.collection->id + std::string(rest);
  const std::string& base = asked.request.base;
  const std::string_view host = asked.request.header("host").value_or("");
  // A base with a host leads through the proxy; what is no host must not stand in an address.
  if (base.find("://") != std::string::npos || !is_host(host)) return base + path;
  return (asked.request.is_secure ? "https://" : "http://") + std::string(host) + base + path;
}

http::Response drawn(const Asked& asked, std::string text, std::string_view media,
                     const QueryCost& cost) {
  http::Response response = text_response(std::move(text), media);
  const bool has_choice = asked.formats.size() > 1 && !asked.formats.front().name.empty();
  if (has_choice && !asked.question.has("f")) response.add("Vary", "Accept");
  add_cost(response, cost);
  return response;
}

http::Response answered(const Asked& asked, std::string text, std::string_view media,
                        const QueryCost& cost, double certified_error, bool exact) {
  http::Response response = drawn(asked, std::move(text), media, cost);
  std::string error;
  append_json_number(error, certified_error);
  response.add("Ptin-Certified-Error", std::move(error));
  response.add("Ptin-Exact", exact ? "true" : "false");
  return response;
}

std::string ended(LongText& text, const Json& members) {
  for (const auto& [name, value] : members.items()) {
    text.add(",\"").add(name).add("\":").json(value);
  }
  return text.add("}\n").take();
}

void add_pair(LongText& text, const MapPoint& p) {
  text.add("[").number(p.x).add(",").number(p.y).add("]");
}

void add_point(LongText& text, const MapPoint& p) {
  text.add(R"({"type":"Point","coordinates":)");
  add_pair(text, p);
  text.add("}");
}

void add_point(LongText& text, MapPoint p, const Places& places) {
  places.from_terrain({&p, 1});
  add_point(text, p);
}

Places places_of(const Asked& asked) {
  return {asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
          asked.request.share};
}

Json certainty_json(const Asked& asked, double certified_error, double certified_deviation,
                    bool exact) {
  return ask::answer_fields().told(kObject).object_of(
      ask::facts_of({certified_error, certified_deviation}, exact, asked.terrain().store(),
                    asked.collection->crs));
}

void check_detail(const Asked& asked, const DetailRequest& detail) {
  const std::size_t least = asked.terrain().store().t0().vertices.size();
  if (!detail.vertices || *detail.vertices >= least) return;
  throw http::Problem(400, "the coarsest TIN has " + std::to_string(least) +
                               " vertices; ask for at least that many")
      .at("vertices");
}

std::optional<Window> window_on_terrain(const Asked& asked, const Places& places,
                                        const std::optional<Window>& bbox) {
  if (!bbox) return std::nullopt;
  if (places.is_geographic() && (bbox->min_y > 90 || bbox->max_y < -90)) {
    throw http::Problem(400,
                        "latitudes are from -90 to 90; a window is west, south, east, north, with "
                        "longitudes first, whatever the order of the CRS's axes is")
        .at("bbox");
  }
  const Window window = places.to_terrain(*bbox);
  const StoreFacts& facts = asked.facts();
  if (GridRegion(window, facts.map).meets(facts.bounds)) return window;
  std::string text = "this window misses the terrain";
  const char* before = ", which has west, south, east, north ";
  if (const auto bounds = places.from_terrain(asked.collection->bounds)) {
    for (const double side : {bounds->min_x, bounds->min_y, bounds->max_x, bounds->max_y}) {
      append_json_number(text.append(before), side);
      before = ", ";
    }
  }
  throw http::Problem(400, text).at("bbox");
}

void check_count(std::size_t count, std::size_t most, std::string_view what, std::string_view name,
                 std::string_view parameter) {
  if (count <= most) return;
  throw http::Problem(413, std::to_string(count) + " " + std::string(what) +
                               " are asked for, and " + std::to_string(most) +
                               " are answered at once; ask in parts")
      .at(std::string(parameter))
      .beyond(std::string(name));
}

}  // namespace ptin::serve
