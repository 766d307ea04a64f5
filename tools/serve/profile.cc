// SPDX-License-Identifier: GPL-3.0-or-later
//
// The height along lines, with a break at every edge of the TIN: `profile`, and OGC EDR's
// `trajectory`, which is the same as a coverage.
#include <span>
#include <string>
#include <vector>

#include "tools/ask/questions.h"
#include "tools/facts/answers.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/lines.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

/// What is told of the profile as a whole.
Json facts_of(const AlongLines& along, const Asked& asked) {
  Json facts = certainty_of(asked, along.profile);
  facts.update(ask::profile_answer_fields().told(kObject).object_of(
      {along.profile, asked.collection->crs, nullptr, along.bent_at_most}));
  return facts;
}

Json certainty_of(const AlongLines& along, const Asked& asked) {
  Json certainty = certainty_of(asked, along.profile);
  certainty["bent_at_most"] = along.bent_at_most;
  return certainty;
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
  const std::vector<std::span<const ProfilePoint>> lines = tools::lines_of(along.profile);
  const auto add_geometry = [&](LongText& text, std::size_t i) {
    const auto begin = static_cast<std::size_t>(lines[i].data() - along.profile.points.data());
    text.add(R"({"type":"MultiLineString","coordinates":[)");
    add_stretches(text, lines[i], std::span(along.client).subspan(begin, lines[i].size()));
    text.add("]}");
  };
  return features_text(asked, ask::profile_line_fields(), lines.size(),
                       [&](std::size_t i) {
                         return ask::ProfileLineRow{lines[i], along.profile};
                       },
                       add_geometry, {{"ptin:certainty", certainty_of(along, asked)}});
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

http::Response respond(const Asked& asked, const ProfileRequest& request,
                       const CoverageNames& names) {
  const ask::Format& format = format_of(asked);
  const Places places = places_of(asked);
  const AlongLines along = walk_lines(asked, request, places);
  const auto row_at = [&](std::size_t i) {
    return ask::ProfileRow{along.profile.points[i], along.client[i],
                           along.profile.certified_deviation};
  };
  std::string text;
  if (format.name == "csv") {
    text = csv_text(asked, ask::profile_fields(), along.client.size(), row_at);
  } else if (format.name == "geojson") {
    text = geojson_of(along, asked);
  } else if (format.name == "covjson") {
    text = coverage_of(along, asked, places, names);
  } else {
    text = points_text(asked, ask::profile_fields(), along.client.size(), row_at,
                       facts_of(along, asked));
  }
  return answered(asked, std::move(text), format.media, along.profile);
}

}  // namespace

http::Response answer_profile(const Asked& asked) {
  return respond(asked, read<ProfileRequest>(asked), {});
}

http::Response answer_trajectory(const Asked& asked) {
  return respond(asked, read<ProfileRequest>(asked), coverage_names(asked));
}

}  // namespace ptin::serve
