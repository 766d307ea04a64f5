// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin volume: cut and fill against a level or another terrain.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/ask/questions.h"
#include "tools/ask/volume_terms.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/plot/volume_plot.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/source_counts.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

constexpr AnswerKinds kAnswerKinds{.layer = false, .plot = true};

struct VolumeOptions {
  TerrainOptions terrain;
  ask::VolumeQuestion question;
  int threads = 0;
  std::optional<std::uint64_t> memory;
  OutputOptions answer;
};

void warn(const std::string& what, const Context& context) {
  if (context.quiet || context.json) return;
  std::fprintf(stderr, "ptin: warning: %s\n", what.c_str());
}

bool knows_height_unit(const CrsFacts& crs) { return crs.vertical_unit != "unknown"; }

/// Heights' units of FILE in one of OTHER's. Where one of the two does not know its unit, it takes
/// that of the other one.
double height_scale(CrsFacts& file, const CrsFacts& other, const VolumeOptions& options,
                    const Context& context) {
  if (const std::optional<double> known = ask::height_scale(file, other)) return *known;
  if (knows_height_unit(file) != knows_height_unit(other)) {
    warn("nothing tells the unit of the heights of " +
             (knows_height_unit(file) ? options.question.against : options.terrain.file) +
             "; taken to be that of the other terrain",
         context);
    if (!knows_height_unit(file)) file.vertical_unit = other.vertical_unit;
  }
  return 1.0;
}

/// @throws Error invalid_argument  positions or heights of the two cannot be compared
void check_comparable(const CrsFacts& file, const CrsFacts& other, const VolumeOptions& options,
                      const Context& context) {
  const std::string mismatch = ask::mismatch_of(file, other, options.terrain.file);
  if (!mismatch.empty()) refuse(mismatch, options.question.against);
  if (file.wkt.empty() != other.wkt.empty()) {
    warn("the CRS of " + (file.wkt.empty() ? options.terrain.file : options.question.against) +
             " is unknown; taken to be that of the other terrain",
         context);
  }
}

VolumeRequest request_of(const VolumeOptions& options, const CrsFacts& crs,
                         const std::optional<Region>& region, const Context& context) {
  VolumeRequest request;
  request.region = region;
  request.detail = options.question.detail;
  ask::set_ground(request, crs);
  request.limits = limits_of(options.memory, context);
  request.threads = thread_count(options.threads);
  return request;
}

ask::VolumeAnswer answer_of(std::span<const VolumeResult> results, std::span<const double> levels,
                            const VolumeOptions& options, const Terrain* other,
                            const CrsFacts& crs) {
  ask::VolumeAnswer answer;
  answer.ground_unit = unit_of_ground(crs);
  for (std::size_t i = 0; i < results.size(); ++i) {
    answer.rows.push_back(
        {&results[i], other == nullptr ? std::optional(levels[i]) : std::nullopt});
  }
  if (other != nullptr) {
    answer.against = options.question.against;
    answer.other_facts = ask::facts_of(results.front().other_certificate, results.front().exact,
                                       other->store(), crs);
  }
  return answer;
}

void print_volumes(const ask::VolumeAnswer& told, const VolumeOptions& options,
                   const StoreFile& store, const CrsFacts& crs,
                   const std::optional<Transformed>& transformed) {
  const VolumeResult& result = *told.rows.front().result;
  ask::AnswerFacts facts = ask::facts_of(result.certificate, result.exact, store, crs);
  facts.transformed = &transformed;
  facts.cost = &result.cost;
  print_answer({{"output", output_json(options.answer)}}, ask::volume_fields(), told, facts);
}

/// The levels that are asked for: none where another terrain stands in their place.
std::vector<double> levels_asked(const VolumeOptions& options, const StoreFacts& facts) {
  constexpr std::size_t kMost = 10'000;
  std::vector<double> levels = options.question.levels.given()
                                   ? ask::levels_of(options.question.levels, facts)
                                   : std::vector<double>{0.0};
  if (levels.size() > kMost) {
    refuse("there are " + grouped(levels.size()) + " levels, more than " + grouped(kMost) +
               "; give a larger --interval",
           "--interval");
  }
  return levels;
}

void print_text(const VolumeResult& result, const VolumeOptions& options, const CrsFacts& crs) {
  const std::string unit = unit_of_ground(crs);
  const std::string known = plural_of(unit == "unknown" ? "unit" : unit);
  const std::string than =
      options.question.against.empty() ? "the level" : options.question.against;
  const std::string& here = options.terrain.file;
  const auto volume = [&](const char* name, const CertifiedVolume& v, const std::string& where) {
    const double off = std::max({result.rounding, v.high - v.value, v.value - v.low});
    std::printf("%-5s %s cubic %s", name, grouped_number(v.value, off).c_str(), known.c_str());
    if (!result.exact) {
      std::printf(", the source's between %s and %s", grouped_number(v.low, off).c_str(),
                  grouped_number(v.high, off).c_str());
    }
    std::printf("%s\n", where.c_str());
  };
  volume("cut", result.cut, ": " + here + " is above " + than + ", material to take away");
  volume("fill", result.fill, ": " + here + " is below " + than + ", material to bring");
  volume("net", result.net, ": cut less fill");
  const double off = 1e-9 * (result.surface_area + result.void_area);  // beyond what rounding does
  const auto area = [off](double value) { return grouped_number(value, off); };
  std::printf("area  %s square %s: cut %s, fill %s; void %s\n", area(result.surface_area).c_str(),
              known.c_str(), area(result.cut_area).c_str(), area(result.fill_area).c_str(),
              area(result.void_area).c_str());
  if (!options.question.against.empty()) {
    std::printf("      surface in %s alone %s, in %s alone %s\n", options.terrain.file.c_str(),
                area(result.only_here_area).c_str(), options.question.against.c_str(),
                area(result.only_other_area).c_str());
  }
  if (std::isfinite(result.mean_difference)) {
    const double of_net = std::max({2 * result.rounding, result.net.high - result.net.value,
                                    result.net.value - result.net.low});
    std::printf("mean  %s %s\n",
                grouped_number(result.mean_difference, of_net / result.surface_area).c_str(),
                known.c_str());
  }
}

int run_volume(const VolumeOptions& options, const Context& context) {
  if (options.question.levels.given() != options.question.against.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "a volume is measured against --level H..., --interval D or --against OTHER; give "
                "one of them");
  }
  const AnswerForm form = form_of(options.answer, context.json, kAnswerKinds);
  if (!options.answer.output.empty() && !options.question.against.empty()) {
    refuse("a table or a plot is of levels, and another terrain has none; leave -o out",
           options.answer.output);
  }
  const Terrain terrain = open_terrain(options.terrain, options.question.detail.tolerance, context);
  CrsFacts crs = crs_facts(terrain.store());
  std::optional<Terrain> other;
  double other_height_scale = 1.0;
  if (!options.question.against.empty()) {
    TerrainOptions of_other = options.terrain;
    of_other.file = options.question.against;
    other = open_terrain(of_other, options.question.detail.tolerance, context);
    const CrsFacts crs_of_other = crs_facts(other->store());
    check_comparable(crs, crs_of_other, options, context);
    other_height_scale = height_scale(crs, crs_of_other, options, context);
  }
  const AskedRegion asked =
      region_of(options.question.region, terrain.store().facts(), crs, context);
  VolumeRequest request = request_of(options, crs, asked.region, context);
  request.other = other ? &*other : nullptr;
  request.other_height_scale = other_height_scale;
  const std::vector<double> levels = levels_asked(options, terrain.store().facts());
  if (!other) request.level = levels.front();
  const std::vector<VolumeResult> results = terrain.volumes(
      request, other ? std::span<const double>{&request.level, 1} : std::span(levels));
  const VolumeResult& result = results.front();
  if (result.surface_area == 0 && has_surface(terrain.store())) {
    warn("no surface lies in the region" +
             (other ? ", or none of both terrains at one place" : std::string()) +
             ": all volumes are 0; ask for another --window or --polygon",
         context);
  }
  const ask::VolumeAnswer told =
      answer_of(results, levels, options, other ? &*other : nullptr, crs);
  const bool is_table = results.size() > 1 || !options.answer.output.empty();
  if (form == AnswerForm::kPlot) {
    plot_volumes(options.answer.output, options.answer.overwrite, results, levels,
                 {unit_of_ground(crs), crs.vertical_unit});
  } else if (is_table) {
    // A row for each level: a stage-storage curve.
    write_rows(
        options.answer, form, context, {}, ask::volume_row_fields(), told.rows.size(),
        [&](std::size_t i) { return told.rows[i]; }, [](std::size_t) { return Geometry(); });
  }
  if (context.json) {
    print_volumes(told, options, terrain.store(), crs, asked.transformed);
  } else if (!is_table) {
    print_text(result, options, crs);
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, VolumeOptions& options) {
  add_terrain(rows, options.terrain, false);
  ask::add_question(rows, options.question);
  ask::add_memory(rows, options.memory);
  add_answer_output(rows, options.answer, kAnswerKinds);
  ask::add_threads(rows, options.threads,
                   "Threads (default: one a processor that affinity and cgroups leave this "
                   "process); the answer is the same for any number");
}

}  // namespace

Declared declare_volume(Context& context) { return declared<VolumeOptions>(context, run_volume); }

}  // namespace ptin::tools
