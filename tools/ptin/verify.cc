// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin verify: every checksum and rule of the file, every split with the records that it needs, and
// with --against every sample of the source. Damage is an answer (exit status 1), not an error.
#include "storage/verify.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <cpl_conv.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "engine/crs/crs_facts.h"
#include "engine/memory_units.h"
#include "engine/remote/remote_file.h"
#include "storage/file/file_questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/output/output_file.h"
#include "tools/progress.h"
#include "tools/ptin/error_stats.h"
#include "tools/ptin/query_options.h"
#include "tools/verify/verify_against.h"

namespace ptin::tools {

namespace {

struct VerifyCommand {
  TerrainOptions terrain;
  std::vector<std::string> against;
  LineInputs lines;
  std::vector<double> tolerances;
  std::string memory, tmp;
  std::size_t faults = 20;
};

/// What was found. `faults` holds those of all three parts: file, splits and source.
struct Findings {
  VerifyReport store;
  bool stopped_early = false;  ///< There may be more faults in the file.
  std::uint64_t cells = 0;     ///< Parts of the terrain in which the splits were applied.
  std::vector<VerifyFault> faults;
  std::uint64_t fault_count = 0;
  std::optional<AgainstReport> against;
};

/// The CRS must be one that outputs can name, and the facts beside its text those of the text.
void verify_crs(const Terrain& terrain, Findings& findings) {
  const std::string wkt = crs_facts(terrain.store()).wkt;
  const nlohmann::json metadata = metadata_of(terrain.store());
  const nlohmann::json crs = metadata.value("crs", nlohmann::json());
  if (crs.is_object() && crs.contains("facts") && crs["facts"] != json_of(crs_facts(wkt))) {
    findings.faults.push_back(
        {"the facts of its CRS are not those of the CRS's text", "section \"metadata\""});
  }
  if (wkt.empty()) return;
  OGRSpatialReference srs;
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  const bool is_known = srs.importFromWkt(wkt.c_str()) == OGRERR_NONE &&
                        srs.exportToWkt(&text, options) == OGRERR_NONE;
  CPLFree(text);
  if (!is_known)
    findings.faults.push_back({"its CRS is no WKT that outputs can name", "section \"metadata\""});
}

/// The terrain, unless there are faults; one more is a T0 that no mesh can begin with.
std::optional<Terrain> open_if_sound(const VerifyCommand& command, const Context& context,
                                     Findings& findings) {
  if (!findings.faults.empty()) return std::nullopt;
  try {
    return open_terrain(command.terrain, context);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corruption) throw;
    findings.faults.push_back({error.message(), error.context()});
    return std::nullopt;
  }
}

/// Holds every record against those that it needs, and validates the full TIN.
void verify_hierarchy(const VerifyCommand& command, const Terrain& terrain, const Context& context,
                      Progress& progress, Findings& findings) {
  HierarchyRequest request;
  request.limits = {memory_limit_of(command.memory, kMemoryOfParts), context.stop};
  request.max_faults = std::max<std::size_t>(1, command.faults);
  request.progress = [&progress](double done) {
    constexpr double kWhole = 1000;
    progress.report("splits", static_cast<std::uint64_t>(done * kWhole),
                    static_cast<std::uint64_t>(kWhole));
  };
  const HierarchyReport report = terrain.check_hierarchy(request);
  findings.cells = report.cells;
  findings.stopped_early = report.stopped_early;
  findings.faults.insert(findings.faults.end(), report.faults.begin(), report.faults.end());
}

/// The tolerances that are checked: those given, else tolerance 0 and four round ones, whose
/// numbers of vertices lie in even steps of a logarithmic scale between that of tolerance 0 and
/// that of T0. The full TIN (no tolerance) comes first in either case.
std::vector<std::optional<double>> tolerances_of(const VerifyCommand& command,
                                                 const StoreFile& store) {
  std::vector<std::optional<double>> tolerances{std::nullopt};
  if (!command.tolerances.empty()) {
    tolerances.insert(tolerances.end(), command.tolerances.begin(), command.tolerances.end());
    return tolerances;
  }
  tolerances.emplace_back(0.0);
  const auto coarsest = static_cast<double>(store.t0().vertices.size());
  const double finest = static_cast<double>(vertices_at(store, 0.0)) / coarsest;
  for (const double step : {0.85, 0.65, 0.45, 0.25}) {
    for (const double tolerance : round_tolerances(store, 60)) {
      if (static_cast<double>(vertices_at(store, tolerance)) > coarsest * std::pow(finest, step))
        continue;
      if (tolerance > tolerances.back().value_or(0.0)) tolerances.emplace_back(tolerance);
      break;
    }
  }
  return tolerances;
}

SampleResources resources_of(const VerifyCommand& command, const Context& context) {
  const ExternalMemory memory{FileLayer::system(),
                              command.tmp.empty() ? folder_of(command.terrain.file) : command.tmp,
                              memory_limit_of(command.memory, kMemoryOfParts)};
  return {memory, context.stop, command.lines};
}

/// Refuses the source of another terrain before anything is verified, which may take long. A file
/// that cannot be opened has faults, which are told later.
void check_source(const VerifyCommand& command, const Context& context) {
  if (command.against.empty()) return;
  std::shared_ptr<const StoreFile> store;
  try {
    store = open_store(command.terrain, context);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corruption) throw;
    return;
  }
  check_is_source(command.against, *store, resources_of(command, context));
}

void verify_source(const VerifyCommand& command, const Terrain& terrain, const Context& context,
                   Progress& progress, Findings& findings) {
  const std::unique_ptr<SourceSamples> source =
      open_samples(command.against, terrain.store(), resources_of(command, context));
  AgainstOptions options;
  options.tolerances = tolerances_of(command, terrain.store());
  options.listed_faults = command.faults;
  options.stop = context.stop;
  options.progress = [&progress](std::uint64_t done, std::uint64_t total) {
    progress.report("samples", done, total);
  };
  findings.against = verify_against(terrain, *source, options);
  findings.fault_count += findings.against->fault_count - findings.against->faults.size();
  for (const std::string& what : findings.against->faults)
    findings.faults.push_back({what, inputs_text(command.against)});
}

Findings verify(const VerifyCommand& command, const Context& context) {
  if (is_remote(command.terrain.file)) {
    refuse("verify reads every byte of a file: copy it to this machine, and verify the copy",
           command.terrain.file);
  }
  check_source(command, context);
  Findings findings;
  Progress progress(Progress::style_for(context.quiet, stderr));
  VerifyOptions options;
  options.memory_bytes =
      std::min(options.memory_bytes, memory_limit_of(command.memory, options.memory_bytes));
  options.max_faults = std::max<std::size_t>(1, command.faults);
  findings.store = verify_store(
      command.terrain.file, options, context.stop,
      [&](std::uint64_t done, std::uint64_t total) { progress.report("pages", done, total); });
  findings.faults = findings.store.faults;
  findings.stopped_early = findings.store.stopped_early;
  // A damaged file answers no questions.
  if (const auto terrain = open_if_sound(command, context, findings)) {
    verify_crs(*terrain, findings);
    verify_hierarchy(command, *terrain, context, progress, findings);
    if (findings.faults.empty() && !command.against.empty())
      verify_source(command, *terrain, context, progress, findings);
  }
  findings.fault_count += findings.faults.size();
  progress.finish();
  return findings;
}

nlohmann::json findings_json(const VerifyCommand& command, const Findings& f) {
  nlohmann::json faults = nlohmann::json::array();
  for (const VerifyFault& fault : f.faults)
    faults.push_back({{"what", fault.what}, {"where", fault.where}});
  nlohmann::json json = {{"file", command.terrain.file},
                         {"sound", f.fault_count == 0},
                         {"fault_count", f.fault_count},
                         {"stopped_early", f.stopped_early},
                         {"faults", faults},
                         {"pages", f.store.pages},
                         {"records", f.store.records},
                         {"index_nodes", f.store.index_nodes}};
  if (!f.against) return json;
  nlohmann::json checks = nlohmann::json::array();
  for (const ToleranceCheck& c : f.against->checks) {
    checks.push_back({{"tolerance", c.tolerance ? nlohmann::json(*c.tolerance) : nlohmann::json()},
                      {"certified_error", c.certified_error},
                      {"worst_error", c.worst_error},
                      {"certified_deviation", number_or_null(c.certified_deviation)},
                      {"worst_deviation", c.worst_deviation},
                      {"samples", c.samples},
                      {"void_samples", c.void_samples},
                      {"reclassified", c.reclassified},
                      {"worst_border_move", c.worst_border_move},
                      {"worst_breakline_error", c.worst_breakline_error},
                      {"faults", c.faults}});
  }
  json["against"] = {{"inputs", command.against}, {"checks", checks}};
  return json;
}

void print_checks(const AgainstReport& report, bool has_lines) {
  std::printf(
      "  tolerance  certified  worst at samples  certified anywhere  worst at random points  "
      "reclassified  worst move of a void's border\n");
  for (const ToleranceCheck& c : report.checks) {
    std::printf("  %9s  %9s  %16s  %18s  %22s  %12s  %28s\n",
                c.tolerance ? short_number(*c.tolerance).c_str() : "none",
                short_number(c.certified_error).c_str(), short_number(c.worst_error).c_str(),
                short_number(c.certified_deviation).c_str(),
                c.tolerance ? short_number(c.worst_deviation).c_str() : "-",
                grouped(c.reclassified).c_str(), short_number(c.worst_border_move).c_str());
    if (has_lines)
      std::printf("             worst along breaklines and boundary: %s\n",
                  short_number(c.worst_breakline_error).c_str());
  }
}

void print_findings(const VerifyCommand& command, const Findings& f) {
  std::printf("%s: %s\n", command.terrain.file.c_str(),
              f.fault_count == 0 ? "sound" : "DAMAGED or wrong");
  std::printf("  %s, %s, %s", counted(f.store.pages, "page").c_str(),
              counted(f.store.records, "record").c_str(),
              counted(f.store.index_nodes, "index node").c_str());
  if (f.cells > 0) std::printf("; splits applied in %s", counted(f.cells, "cell").c_str());
  std::printf("\n");
  if (f.against && !f.against->checks.empty()) {
    std::printf("against %s: %s with a height, %s void\n", inputs_text(command.against).c_str(),
                counted(f.against->checks.front().samples, "sample").c_str(),
                grouped(f.against->checks.front().void_samples).c_str());
    print_checks(*f.against, !command.lines.is_empty());
  }
  if (f.fault_count == 0) return;
  std::printf("%s%s; the first:\n", counted(f.fault_count, "fault").c_str(),
              f.stopped_early ? " or more" : "");
  for (const VerifyFault& fault : f.faults) {
    std::printf("  %s%s%s\n", fault.where.c_str(), fault.where.empty() ? "" : ": ",
                fault.what.c_str());
  }
}

}  // namespace

Action declare_verify(CLI::App& app, Context& context) {
  const auto command = std::make_shared<VerifyCommand>();
  add_terrain_options(app, command->terrain, false);
  auto* against =
      app.add_option(
             "--against", command->against,
             "The source, every input of the build: certified errors are checked at each of its\n"
             "samples")
          ->type_name("INPUT...");
  app.add_option("--breaklines", command->lines.breaklines,
                 "The files of breaklines of the build: the TIN is held against them")
      ->needs(against)
      ->type_name("FILE...");
  app.add_option("--boundary", command->lines.boundary, "The file of the boundary of the build")
      ->needs(against)
      ->type_name("FILE");
  command->terrain.measures
      .add(app, "--tolerance", command->tolerances, MeasureKind::kHeight, NumberRange::kNotNegative,
           "Tolerances to check against the source (default: 0 and four more)")
      ->needs(against)
      ->type_name("E...");
  app.add_option("--memory", command->memory,
                 "Memory to check the splits in, and to sort the points of the source in, as "
                 "512M or 2G (default 1G)")
      ->type_name("SIZE");
  app.add_option("--tmp", command->tmp,
                 "Folder for temporary files of points that do not fit (default: beside FILE)")
      ->check(CLI::ExistingDirectory)
      ->type_name("DIR");
  app.add_option("--faults", command->faults, "List at most this many faults")
      ->capture_default_str()
      ->type_name("N");
  return [command, &context] {
    const Findings findings = verify(*command, context);
    if (context.json) {
      print_json(findings_json(*command, findings));
    } else if (!context.quiet || findings.fault_count > 0) {
      print_findings(*command, findings);
    }
    return findings.fault_count == 0 ? kExitDone : kExitNegative;
  };
}

}  // namespace ptin::tools
