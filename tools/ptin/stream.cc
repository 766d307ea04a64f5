// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin stream: a terrain as bytes of which the first few are a coarse terrain.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/query_options.h"
#include "tools/region/serving.h"

namespace ptin::tools {

namespace {

struct StreamOptions {
  TerrainOptions terrain;
  Serving wanted, had;
  std::string have;
  std::string memory, output;
  bool stats = false;
  bool overwrite = false;
};

void check_options(const StreamOptions& options, const Context& context) {
  if (options.output != "-") {
    check_output(options.output, options.overwrite);
    return;
  }
  if (context.json) {
    throw Error(ErrorCode::invalid_argument,
                "--json and -o - both write to stdout; give the stream a file name");
  }
  if (::isatty(STDOUT_FILENO) != 0) {
    throw Error(ErrorCode::invalid_argument,
                "a stream is binary: redirect stdout, or give the stream a file name");
  }
}

std::vector<StreamHeld> held_of(const StreamOptions& options, const StoreFacts& facts) {
  std::vector<StreamHeld> held;
  const auto add = [&](const Serving& s, const char* option) {
    held.push_back({predicate_of(s, facts, option), s.splits.value_or(StreamHeld{}.splits)});
  };
  if (!options.have.empty()) {
    for (const Serving& s : servings_of(options.have)) add(s, "--have");
  }
  if (options.had.given()) add(options.had, "--have-window");
  return held;
}

StreamSummary send(const StreamOptions& options, const Terrain& terrain,
                   const StreamRequest& request) {
  if (options.output == "-") {
    const StreamSummary summary = terrain.stream(request, [](std::span<const std::byte> bytes) {
      write_to_stdout({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    });
    finish_stdout();
    return summary;
  }
  OutputFile out(options.output, options.overwrite);
  const StreamSummary summary = terrain.stream(
      request, [&](std::span<const std::byte> bytes) { out.write(bytes.data(), bytes.size()); });
  out.publish();
  return summary;
}

void print_stats(const StreamOptions& options, const StreamSummary& s) {
  std::fprintf(stderr, "%s: %s on %s in %s, %s\n", options.output.c_str(),
               counted(s.splits, "split").c_str(),
               counted(s.base_vertices, "vertex", "vertices").c_str(),
               counted(s.frames, "frame").c_str(), human_bytes(s.bytes).c_str());
  if (s.splits != 0) {
    std::fprintf(stderr, "  size       %.2f bytes a split\n",
                 static_cast<double>(s.bytes) / static_cast<double>(s.splits));
  }
  std::fprintf(stderr, "  certified  %s at every sample, %s at any point of what was asked for\n",
               short_number(s.certificate.error).c_str(),
               short_number(s.certificate.deviation).c_str());
  std::fprintf(stderr, "  cost       %s retrieved, %s, %.3f s\n",
               counted(s.cost.records_retrieved, "record").c_str(),
               counted(s.cost.io.pages, "page").c_str(), s.cost.seconds);
}

int run_stream(const StreamOptions& options, const Context& context) {
  check_options(options, context);
  const Terrain terrain = open_terrain(options.terrain, context);
  const StoreFile& store = terrain.store();
  warn_of_terrain(store, options.wanted.error, context);
  StreamRequest request;
  request.wanted = predicate_of(options.wanted, store.facts(), "--window");
  request.tolerance = options.wanted.error;
  request.held = held_of(options, store.facts());
  if (options.wanted.splits) request.most_splits = *options.wanted.splits;
  request.metadata = metadata_of_stream(store, options.wanted);
  request.limits = limits_of(options.memory, context);
  const StreamSummary summary = send(options, terrain, request);
  if (context.json) {
    print_json({{"output", options.output},
                {"base_vertices", summary.base_vertices},
                {"splits", summary.splits},
                {"frames", summary.frames},
                {"bytes", summary.bytes},
                {"split_bytes", summary.split_bytes},
                {"certified_error", summary.certificate.error},
                {"certified_deviation", summary.certificate.deviation},
                {"border_moved_at_most", border_move_json(store, summary.certificate.error)},
                {"exact", summary.certificate.complete && store.facts().base_error == 0},
                {"units", units_json(crs_facts(store))},
                {"cost", cost_json(summary.cost)}});
  } else if (options.stats) {
    print_stats(options, summary);
  }
  return kExitDone;
}

/// Declares --window, --error, --level and --splits with a common prefix.
void add_serving(CLI::App& app, Measures& measures, Serving& serving, const std::string& prefix,
                 const std::string& what) {
  app.add_option("--" + prefix + "window", serving.window, what + " window, in map units")
      ->expected(4)
      ->type_name("XMIN YMIN XMAX YMAX");
  constexpr MeasureKind kHeight = MeasureKind::kHeight;
  measures
      .add(app, "--" + prefix + "error", serving.error, kHeight, NumberRange::kTolerance,
           what + " certified error, in the height's unit, or as 50cm")
      ->type_name("E");
  measures
      .add(app, "--" + prefix + "level", serving.levels, kHeight, NumberRange::kFinite,
           what + " heights: only what isolines at them need")
      ->expected(1, 1000)
      ->type_name("H...");
  app.add_option("--" + prefix + "splits", serving.splits,
                 what + " number of splits: only the first so many, the most important ones")
      ->type_name("N")
      ->check(counts());
}

}  // namespace

Action declare_stream(CLI::App& app, Context& context) {
  const auto options = std::make_shared<StreamOptions>();
  add_terrain_options(app, options->terrain, false);
  add_serving(app, options->terrain.measures, options->wanted, "", "What to send:");
  add_serving(app, options->terrain.measures, options->had, "have-",
              "What the receiver was served before:");
  app.add_option("--have", options->have,
                 "What the receiver was served before, as `ptin unstream --json` prints it")
      ->type_name("JSON");
  app.add_option("-o,--output", options->output, "The stream to write; - for stdout")
      ->type_name("OUT")
      ->required();
  app.add_flag("--stats", options->stats, "Print, on stderr, what was sent and what it cost");
  add_memory_option(app, options->memory);
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_stream(*options, context); };
}

}  // namespace ptin::tools
