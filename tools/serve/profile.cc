// SPDX-License-Identifier: GPL-3.0-or-later
//
// The height along lines, with a break at every edge of the TIN: `profile`, and OGC EDR's
// `trajectory`, which is the same as a coverage.
#include "tools/ask/profile.h"

#include <span>
#include <string>
#include <vector>

#include "tools/facts/answers.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/lines.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

struct TrajectoryQuestion : LinesQuestion {
  CoverageNames names;
};

ask::Parameters parameters_of(TrajectoryQuestion& question) {
  ask::Parameters rows = parameters_of(static_cast<LinesQuestion&>(question));
  add_coverage_rows(rows, question.names);
  return rows;
}

ask::ProfileRow row_of(const AlongLines& along, std::size_t i) {
  return {along.profile.points[i], along.client[i], along.profile.certified_deviation};
}

std::string csv_of(const AlongLines& along, const Asked& asked) {
  const auto columns =
      ask::columns_of(ask::profile_fields(), ask::Door::kService, ask::As::kTableRow);
  LongText text = long_text(asked);
  ask::add_csv_heading(text, columns);
  for (std::size_t i = 0; i < along.client.size(); ++i) {
    ask::add_csv_row(text, columns, row_of(along, i));
  }
  return text.take();
}

/// What is told of the profile as a whole.
Json facts_of(const AlongLines& along, const Asked& asked) {
  Json facts = certainty_of(asked, along.profile);
  put(facts, ask::profile_answer_fields(),
      ask::ProfileAnswer{along.profile, asked.collection->crs, nullptr, along.bent_at_most},
      ask::Door::kService);
  return facts;
}

Json certainty_of(const AlongLines& along, const Asked& asked) {
  Json certainty = certainty_of(asked, along.profile);
  certainty["bent_at_most"] = along.bent_at_most;
  return certainty;
}

std::string json_of(const AlongLines& along, const Asked& asked) {
  const auto columns =
      ask::columns_of(ask::profile_fields(), ask::Door::kService, ask::As::kObject);
  LongText text = long_text(asked);
  text.add("{\"points\":[");
  for (std::size_t i = 0; i < along.client.size(); ++i) {
    ask::add_object(i == 0 ? text : text.add(","), columns, row_of(along, i));
  }
  text.add("]");
  ask::add_members(text, facts_of(along, asked));
  return text.add("}\n").take();
}

/// The stretches of a line that have heights, as arrays of positions.
void add_stretches(LongText& text, std::span<const ProfilePoint> points,
                   std::span<const MapPoint> client) {
  const char* before = "[";
  ask::for_each_stretch(points, [&](std::size_t first, std::size_t last) {
    text.add(before);
    before = ",[";
    for (std::size_t i = first; i <= last; ++i) {
      text.add(i == first ? "[" : ",[").number(client[i].x).add(",");
      text.number(client[i].y).add(",").number(points[i].height).add("]");
    }
    text.add("]");
  });
}

std::string geojson_of(const AlongLines& along, const Asked& asked) {
  const auto columns =
      ask::columns_of(ask::profile_line_fields(), ask::Door::kService, ask::As::kFeature);
  LongText text = long_text(asked);
  text.add(R"({"type":"FeatureCollection","features":[)");
  std::size_t begin = 0;
  for (const std::span<const ProfilePoint> line : tools::lines_of(along.profile)) {
    text.add(begin == 0 ? "{" : ",{").add(R"("type":"Feature","geometry":)");
    text.add(R"({"type":"MultiLineString","coordinates":[)");
    add_stretches(text, line, std::span(along.client).subspan(begin, line.size()));
    text.add(R"(]},"properties":)");
    ask::add_object(text, columns, ask::ProfileLineRow{line, along.profile});
    text.add("}");
    begin += line.size();
  }
  return text.add("],\"ptin:certainty\":").json(certainty_of(along, asked)).add("}\n").take();
}

std::string coverage_of(const AlongLines& along, const Asked& asked, const Places& places,
                        const CoverageNames& names) {
  const auto value = [&](std::size_t i) {
    const ProfilePoint& p = along.profile.points[i];
    const double deviation = along.profile.certified_deviation;
    // The last point before a gap stands on surface: it has a height, whatever begins there.
    const CoverageState state = p.height == p.height           ? CoverageState::kSurface
                                : p.state == PointState::kVoid ? CoverageState::kVoid
                                                               : CoverageState::kOutside;
    return CoverageValue{p.height, p.height - deviation, p.height + deviation, state};
  };
  return coverage_text(asked, places, names, coverage_at(along.client, value),
                       certainty_of(along, asked));
}

http::Response respond(const Asked& asked, const LinesQuestion& question,
                       const CoverageNames& names) {
  const ask::Format& format = format_of(asked);
  const Places places = places_of(asked, question.crs);
  const AlongLines along = walk_lines(asked, question, places);
  std::string text;
  if (format.name == "csv") {
    text = csv_of(along, asked);
  } else if (format.name == "geojson") {
    text = geojson_of(along, asked);
  } else if (format.name == "covjson") {
    text = coverage_of(along, asked, places, names);
  } else {
    text = json_of(along, asked);
  }
  return answered(asked, std::move(text), format.media, along.profile.cost,
                  along.profile.certified_error, along.profile.exact);
}

}  // namespace

ask::Parameters profile_parameters() { return described<LinesQuestion>(); }
ask::Parameters trajectory_parameters() { return described<TrajectoryQuestion>(); }

http::Response answer_profile(const Asked& asked) {
  return respond(asked, read<LinesQuestion>(asked), {});
}

http::Response answer_trajectory(const Asked& asked) {
  const auto question = read<TrajectoryQuestion>(asked);
  return respond(asked, question, question.names);
}

}  // namespace ptin::serve
