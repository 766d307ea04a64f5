// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest or lowest point of a window, as GeoJSON.
#include <array>
#include <string>
#include <vector>

#include "tools/ask/questions.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

http::Response answer_highest(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<ask::HighestQuestion>(asked);
  const Places places = places_of(asked);
  HighestRequest& request = question.request;
  if (question.region.window) request.region = places.to_terrain(*question.region.window);
  check_count(request.listed, asked.options.question.points, "vertices", "points", "listed");
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked, request.listed * kAnswerBytesOfPlace);
  const HighestResult result = asked.terrain().highest(request);
  const std::vector<ask::HighestPlace> all = ask::places_of(result);
  Json more = ask::highest_fields().told(kObject).object_of(result);
  more["ptin:certainty"] = certainty_of(asked, result);
  std::string text = features_text(
      asked, ask::highest_place_fields(), all.size(), [&](std::size_t i) { return all[i]; },
      [&](LongText& to, std::size_t i) { add_point(to, all[i].at.position, places); }, more);
  return answered(asked, std::move(text), format.media, result);
}

}  // namespace ptin::serve
