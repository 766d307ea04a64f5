// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin highest: the highest or the lowest point of a window or a polygon.
#include <cstdio>
#include <optional>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct HighestOptions {
  TerrainOptions terrain;
  ask::HighestQuestion question;
  std::optional<std::uint64_t> memory;
};

void print_text(const HighestResult& result, const HighestOptions& options, bool has_voids) {
  if (result.state != PointState::kSurface) {
    std::printf("%s\n", name_of(result.state));
    return;
  }
  const auto text = [](const HeightAt& v) {
    return exact_number(v.height) + " at " + exact_number(v.position.x) + " " +
           exact_number(v.position.y);
  };
  const char* border = options.question.region.polygon.empty() ? "on the window's border"
                                                               : "on the polygon's border";
  std::printf("%s %s (%s)\n", options.question.request.lowest ? "lowest" : "highest",
              text(result.point).c_str(), result.at_vertex ? "a vertex" : border);
  if (!result.exact) {
    std::printf("  the source's lies between %s and %s%s\n",
                exact_number(result.height_min).c_str(), exact_number(result.height_max).c_str(),
                has_voids ? ", as long as no void of either comes into it" : "");
  }
  for (const HeightAt& v : result.vertices) std::printf("  vertex %s\n", text(v).c_str());
}

int run_highest(const HighestOptions& options, const Context& context) {
  const Terrain terrain =
      open_terrain(options.terrain, options.question.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const AskedRegion asked =
      region_of(options.question.region, terrain.store().facts(), crs, context);
  HighestRequest request = options.question.request;
  request.region = asked.region;
  request.limits = limits_of(options.memory, context);
  const HighestResult result = terrain.highest(request);
  if (!context.json) {
    print_text(result, options, !terrain.store().facts().free_of_voids);
    return kExitDone;
  }
  print_answer({}, ask::highest_fields(request.lowest), result,
               ask::facts_of(result, terrain.store(), crs, &asked.transformed));
  return kExitDone;
}

void add_question(ask::Parameters& rows, HighestOptions& options) {
  add_terrain(rows, options.terrain, false);
  ask::add_question(rows, options.question);
  ask::add_memory(rows, options.memory);
}

}  // namespace

Declared declare_highest(Context& context) {
  return declared<HighestOptions>(context, run_highest);
}

}  // namespace ptin::tools
