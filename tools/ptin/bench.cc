// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin bench: how long questions take on this disk, cold and warm, and which way of reading is best.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "storage/file/sigbus_guard.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/measure/measure_io.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/plot/canvas.h"
#include "tools/plot/io_plot.h"
#include "tools/progress.h"
#include "tools/ptin/bench_report.h"
#include "tools/ptin/query_options.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct BenchOptions {
  IoRequest request;
  int threads = 0;
  std::optional<std::uint64_t> memory;
  OutputOptions out;
};

void check_plot(const BenchOptions& options) {
  if (options.out.output.empty()) return;
  if (!is_picture_name(options.out.output)) {
    throw Error(ErrorCode::invalid_argument,
                "unknown extension; the plot's name ends in " + known_picture_extensions(),
                options.out.output);
  }
  check_output(options.out.output, options.out.overwrite);
}

int run_bench(const BenchOptions& options, const Context& context) {
  if (context.reading->waits()) {
    context.reading->settle(crs_facts(*StoreFile::open(options.request.file)));
  }
  IoRequest request = options.request;
  check_plot(options);
  install_sigbus_guard();
  request.most_threads = thread_count(options.threads);
  request.memory_bytes = memory_limit_of(options.memory);
  request.stop = context.stop;
  Progress progress(Progress::style_for(context.quiet, stderr));
  request.progress = [&](const char* stage, double share) {
    progress.report(stage, static_cast<std::uint64_t>(share * 1000), 1000);
  };
  const IoReport report = measure_io(request);
  progress.finish();
  if (!options.out.output.empty())
    plot_io(options.out.output, options.out.overwrite, request, report);
  if (!context.json) {
    write_to_stdout(text_of(request, report));
    return kExitDone;
  }
  ask::Json answer = json_of(request, report);
  answer["output"] =
      options.out.output.empty() ? nlohmann::json() : nlohmann::json(options.out.output);
  answer["units"] = ask::units_json(crs_facts(*StoreFile::open(request.file)));
  print_json(answer);
  return kExitDone;
}

void add_question(ask::Parameters& rows, BenchOptions& options) {
  IoRequest& request = options.request;
  rows.add("file", &request.file, "", "The .ptin file")
      .spelled("FILE")
      .required_at(ask::Door::kBoth);
  rows.add("seconds", &request.seconds, "S",
           "How long to measure, about; questions that take long may double it")
      .within(NumberRange::kPositive)
      .with_default();
  rows.add("count", &request.most_times, "N", "How often each question is asked, at most")
      .within({.least = 1, .most = 1e6})
      .with_default();
  rows.add("seed", &request.seed, "N", "Of the places that are asked for").with_default();
  ask::add_error(rows, request.tolerance, "Ask at a certified error; without it exact");
  ask::add_threads(rows, options.threads,
                   "Most threads to ask at once (default: those that the process may use)", 4096);
  ask::add_memory(rows, options.memory);
  rows.add("tmp", &request.temporary_folder, "DIR",
           "Folder for libspatialindex's tree, which is removed again (default: beside FILE)");
  add_output(rows, options.out, "Draw the figures (" + known_picture_extensions() + ")", false,
             "PLOT");
}

}  // namespace

Declared declare_bench(Context& context) { return declared<BenchOptions>(context, run_bench); }

}  // namespace ptin::tools
