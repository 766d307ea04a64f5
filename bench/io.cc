// SPDX-License-Identifier: GPL-3.0-or-later
//
// What questions read from files of several page sizes, cold: what `ptin bench` measures of one
// file (tools/API.md, "Benchmarks"), page size by page size. Which way of reading is best is asked
// of a user's own file, by `ptin bench`.
//
// usage: io RASTER [-o OUT.csv] [--pages KIB...] [--seconds S] [--count N]
// builds a store for each page size in the build folder first
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/support/scratch.h"
#include "engine/construct/build.h"
#include "tools/measure/measure_io.h"

namespace {

using namespace ptin;
using tools::QuestionFigures;

struct PageStudy {
  std::string raster, csv;
  std::vector<std::uint32_t> page_kib = {4, 8, 16};
  double seconds = 60;
  std::uint64_t most_times = 200;
};

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

/// A row of the table on stdout, and of the CSV where there is one.
void tell(std::uint32_t kib, const char* question, const char* way, const tools::Readings& cold,
          std::FILE* csv) {
  const double device = cold.mean_device_bytes().value_or(0) / 1024;
  const double ms = cold.seconds().median.value_or(0) * 1e3;
  const auto print = [&](std::FILE* out, const char* form) {
    std::fprintf(out, form, kib, question, way, cold.all().size(), cold.mean_pages(),
                 cold.mean_nodes(), cold.mean_asked_bytes() / 1024, device,
                 cold.mean_major_faults(), ms);
  };
  print(stdout, "| %u | %s | %s | %zu | %.1f | %.1f | %.0f | %.0f | %.1f | %.3g |\n");
  if (csv != nullptr) print(csv, "%u,%s,%s,%zu,%.2f,%.2f,%.1f,%.1f,%.2f,%.4f\n");
}

void measure(const PageStudy& study, std::uint32_t kib, const std::string& path, std::FILE* csv) {
  tools::IoRequest request;
  request.file = path;
  request.seconds = study.seconds;
  request.most_times = study.most_times;
  const tools::IoReport report = tools::measure_io(request);
  if (!report.why_not_cold.empty())
    throw Error(ErrorCode::io_error, "nothing can be cold: " + report.why_not_cold, path);
  for (const auto& opening : report.opening) {
    tell(kib, "open", name_of(opening.way), opening.cold, csv);
  }
  for (const QuestionFigures& f : report.questions) {
    tell(kib, name_of(f.kind), name_of(f.way), f.cold, csv);
  }
}

void run(const PageStudy& study) {
  const bench::ScratchFolder folder;
  const File csv(study.csv.empty() ? nullptr : std::fopen(study.csv.c_str(), "w"), std::fclose);
  if (!study.csv.empty() && !csv) throw Error(ErrorCode::io_error, "cannot write", study.csv);
  if (csv)
    std::fputs("page_kib,question,way,times,pages,nodes,asked_kib,device_kib,major_faults,ms\n",
               csv.get());
  std::puts(
      "| page | question | way | times | pages | nodes | asked KiB | device KiB | major faults | "
      "ms |\n|---|---|---|---|---|---|---|---|---|---|");
  for (const std::uint32_t kib : study.page_kib) {
    BuildOptions options;
    options.page_bytes = kib * 1024;
    const std::string path = folder.file("pages" + std::to_string(kib) + ".ptin");
    const BuildReport built = build({study.raster}, path, options, {});
    std::fprintf(stderr, "%u KiB: %llu records, %.2f bytes a vertex\n", kib,
                 static_cast<unsigned long long>(built.records),
                 double(built.file_bytes) / double(built.vertices));
    measure(study, kib, path, csv.get());
    std::remove(path.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What questions read from files of several page sizes, cold");
  PageStudy study;
  app.add_option("RASTER", study.raster, "A raster that GDAL reads")->required();
  app.add_option("-o,--output", study.csv, "The CSV to write");
  app.add_option("--pages", study.page_kib, "Page sizes, KiB");
  app.add_option("--seconds", study.seconds, "For each page size");
  app.add_option("--count", study.most_times, "Of each question by each way, at most");
  CLI11_PARSE(app, argc, argv);
  try {
    run(study);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "io: %s\n", e.what());
    return 70;
  }
  return 0;
}
