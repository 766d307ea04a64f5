// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin bench: how long questions take on this disk, cold and warm, and which way of reading is best.
#include <cmath>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "storage/file/sigbus_guard.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/numbers.h"
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
  Measures measures;
  int threads = 0;
  std::string memory;
  std::string output;
  bool overwrite = false;
};

void check_plot(const BenchOptions& options) {
  if (options.output.empty()) return;
  if (!is_picture_name(options.output)) {
    throw Error(ErrorCode::invalid_argument,
                "unknown extension; the plot's name ends in " + known_picture_extensions(),
                options.output);
  }
  check_output(options.output, options.overwrite);
}

int run_bench(const BenchOptions& options, const Context& context) {
  if (options.measures.wait()) {
    options.measures.settle(crs_facts(*StoreFile::open(options.request.file)));
  }
  IoRequest request = options.request;
  if (!(request.seconds > 0) || !std::isfinite(request.seconds))
    throw Error(ErrorCode::invalid_argument, "--seconds must be a finite number above 0");
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
  if (!options.output.empty()) plot_io(options.output, options.overwrite, request, report);
  if (!context.json) {
    write_to_stdout(text_of(request, report));
    return kExitDone;
  }
  nlohmann::json answer = json_of(request, report);
  answer["output"] = options.output.empty() ? nlohmann::json() : nlohmann::json(options.output);
  answer["units"] = units_json(crs_facts(*StoreFile::open(request.file)));
  print_json(answer);
  return kExitDone;
}

}  // namespace

Action declare_bench(CLI::App& app, Context& context) {
  const auto options = std::make_shared<BenchOptions>();
  IoRequest& request = options->request;
  app.add_option("FILE", request.file, "The .ptin file")->required();
  app.add_option("--seconds", request.seconds,
                 "How long to measure, about; questions that take long may double it")
      ->check(numbers(NumberRange::kPositive, ""))
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--count", request.most_times, "How often each question is asked, at most")
      ->type_name("N")
      ->check(CLI::Range(1U, 1000000U))
      ->capture_default_str();
  app.add_option("--seed", request.seed, "Of the places that are asked for")
      ->type_name("N")
      ->check(counts())
      ->capture_default_str();
  add_error_option(app, options->measures, request.tolerance,
                   "Ask at a certified error, in the height's unit, or as 50cm (default: exact)");
  app.add_option("--threads", options->threads,
                 "Most threads to ask at once (default: those that the process may use)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  add_memory_option(app, options->memory);
  app.add_option("--tmp", request.temporary_folder,
                 "Folder for libspatialindex's tree, which is removed again (default: beside FILE)")
      ->type_name("DIR");
  app.add_option("-o,--output", options->output,
                 "Draw the figures (" + known_picture_extensions() + ")")
      ->type_name("PLOT");
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_bench(*options, context); };
}

}  // namespace ptin::tools
