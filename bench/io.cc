// SPDX-License-Identifier: GPL-3.0-or-later
//
// What questions read from files of several page sizes, cold: what `ptin bench` measures of one
// file (tools/API.md, "Benchmarks"), page size by page size. Which way of reading is best is asked
// of a user's own file, by `ptin bench`.
//
// usage: io RASTER [-o OUT.csv] [--pages KIB...] [--seconds S] [--count N]
// builds a store for each page size in the build folder first
#include <cstdio>
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

/// A row of the CSV.
void tell(std::uint32_t kib, const char* question, const char* way, const tools::Readings& cold,
          std::FILE* csv) {
  std::fprintf(csv, "%u,%s,%s,%zu,%.2f,%.2f,%.1f,%.1f,%.2f,%.4f\n", kib, question, way,
               cold.all().size(), cold.mean_pages(), cold.mean_nodes(),
               cold.mean_asked_bytes() / 1024, cold.mean_device_bytes().value_or(0) / 1024,
               cold.mean_major_faults(), cold.seconds().median.value_or(0) * 1e3);
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

void run(const PageStudy& study, std::FILE* csv) {
  const bench::ScratchFolder folder;
  std::fputs("page_kib,question,way,times,pages,nodes,asked_kib,device_kib,major_faults,ms\n", csv);
  for (const std::uint32_t kib : study.page_kib) {
    BuildOptions options;
    options.page_bytes = kib * 1024;
    const std::string path = folder.file("pages" + std::to_string(kib) + ".ptin");
    const BuildReport built = build({study.raster}, path, options, {});
    std::fprintf(stderr, "%u KiB: %llu records, %.2f bytes a vertex\n", kib,
                 static_cast<unsigned long long>(built.records),
                 double(built.file_bytes) / double(built.vertices));
    measure(study, kib, path, csv);
    std::remove(path.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What questions read from files of several page sizes, cold");
  PageStudy study;
  app.add_option("RASTER", study.raster, "A raster that GDAL reads")->required();
  app.add_option("-o,--output", study.csv, "The CSV to write (default: standard output)");
  app.add_option("--pages", study.page_kib, "Page sizes, KiB");
  app.add_option("--seconds", study.seconds, "For each page size");
  app.add_option("--count", study.most_times, "Of each question by each way, at most");
  CLI11_PARSE(app, argc, argv);
  std::FILE* csv = study.csv.empty() ? stdout : std::fopen(study.csv.c_str(), "w");
  if (csv == nullptr) {
    std::perror(study.csv.c_str());
    return 6;
  }
  try {
    run(study, csv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "io: %s\n", e.what());
    return 70;
  }
  return std::fclose(csv) == 0 ? 0 : 6;
}
