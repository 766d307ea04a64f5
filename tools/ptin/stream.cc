// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin stream: a terrain as bytes of which the first few are a coarse terrain.
#include <cstdio>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "storage/file/file_questions.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/query_options.h"
#include "tools/region/serving.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct StreamOptions {
  TerrainOptions terrain;
  Serving wanted, had;
  std::string have;
  std::optional<std::uint64_t> memory;
  int threads = 0;
  OutputOptions out;
  bool stats = false;
};

void check_options(const StreamOptions& options, const Context& context) {
  check_file_or_stdout(options.out, "the stream", context.json);
  if (options.out.output == "-" && ::isatty(STDOUT_FILENO) != 0) {
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

std::string folder_for_temporaries(const StreamOptions& options) {
  if (!options.terrain.temporary_folder.empty()) return options.terrain.temporary_folder;
  return options.out.output != "-" ? folder_of(options.out.output) : system_temporary_folder();
}

StreamSummary send(const StreamOptions& options, const Terrain& terrain,
                   const StreamRequest& request) {
  if (options.out.output == "-") {
    const StreamSummary summary = terrain.stream(request, [](std::span<const std::byte> bytes) {
      write_to_stdout({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    });
    finish_stdout();
    return summary;
  }
  OutputFile out(options.out.output, options.out.overwrite);
  const StreamSummary summary = terrain.stream(
      request, [&](std::span<const std::byte> bytes) { out.write(bytes.data(), bytes.size()); });
  out.publish();
  return summary;
}

void print_stats(const StreamOptions& options, const StreamSummary& s) {
  std::fprintf(stderr, "%s: %s on %s in %s, %s\n", options.out.output.c_str(),
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
  const Terrain terrain = open_terrain(options.terrain, options.wanted.error, context);
  const StoreFile& store = terrain.store();
  StreamRequest request;
  request.wanted = predicate_of(options.wanted, store.facts(), "--window");
  request.tolerance = options.wanted.error;
  request.held = held_of(options, store.facts());
  if (options.wanted.splits) request.most_splits = *options.wanted.splits;
  request.metadata = metadata_of_stream(store, options.wanted);
  request.limits = limits_of(options.memory, context);
  request.temporary_folder = folder_for_temporaries(options);
  request.threads = thread_count(options.threads);
  const StreamSummary summary = send(options, terrain, request);
  if (context.json) {
    const CrsFacts crs = crs_facts(store);
    ask::AnswerFacts facts =
        ask::facts_of(summary.certificate,
                      summary.certificate.complete && store.facts().base_error == 0, store, crs);
    facts.cost = &summary.cost;
    print_answer({{"output", options.out.output}}, ask::stream_fields(), summary, facts);
  } else if (options.stats) {
    print_stats(options, summary);
  }
  return kExitDone;
}

/// --window, --error, --level and --splits of what to send, or with --have- of what was sent before.
void add_serving(ask::Parameters& rows, Serving& serving, bool is_had) {
  const std::string what = is_had ? "What the receiver was served before:" : "What to send:";
  rows.add(is_had ? "have-window" : "window", &serving.window, "XMIN YMIN XMAX YMAX",
           what + " window")
      .in(ask::Unit::kMap)
      .values(4, 4);
  ask::add_error(rows, serving.error, what + " certified error").name =
      is_had ? "have-error" : "error";
  rows.add(is_had ? "have-level" : "level", &serving.levels, "H...",
           what + " heights: only what isolines at them need")
      .in(ask::Unit::kHeight)
      .values(1, 1000);
  rows.add(is_had ? "have-splits" : "splits", &serving.splits, "N",
           what + " number of splits: only the first so many, the most important ones");
}

void add_question(ask::Parameters& rows, StreamOptions& options) {
  add_terrain(rows, options.terrain, false);
  add_serving(rows, options.wanted, false);
  add_serving(rows, options.had, true);
  rows.add("have", &options.have, "JSON",
           "What the receiver was served before, as `ptin unstream --json` prints it");
  add_output(rows, options.out, "The stream to write; - for stdout");
  rows.add("stats", &options.stats, "", "Print, on stderr, what was sent and what it cost");
  ask::add_memory(rows, options.memory,
                  "Memory, as 512M or 2G (default 4G); what does not fit goes to --tmp");
  rows.add("tmp", &options.terrain.temporary_folder, "DIR",
           "Folder for temporary files: what does not fit in --memory (default: OUT's folder)");
  ask::add_threads(
      rows, options.threads,
      "Threads for what does not fit in --memory (default: one a processor that "
      "affinity and cgroups leave this process); the bytes are the same for any number");
}

}  // namespace

Declared declare_stream(Context& context) { return declared<StreamOptions>(context, run_stream); }

}  // namespace ptin::tools
