// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin build: from a source to a .ptin file, with a report.
#include "engine/construct/build.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include <malloc.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/memory_plan.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "storage/file/sigbus_guard.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/output/output_file.h"
#include "tools/progress.h"
#include "tools/progress_fd.h"
#include "tools/ptin/build_cluster.h"
#include "tools/ptin/error_stats.h"
#include "tools/ptin/query_options.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct BuildCommand {
  std::vector<std::string> inputs;
  std::string output;
  std::string cost = "error";
  std::string duplicates, returns;
  std::vector<double> bbox;
  BuildOptions options;
  bool overwrite = false;
  std::string memory, tmp;
  int threads = 0;
  bool resume = false, discard = false, dry_run = false;
  int progress_fd = -1;
};

CostModel cost_of(const std::string& name) {
  if (name == "roi") return CostModel::kRoi;
  return name == "elevation" ? CostModel::kElevation : CostModel::kError;
}

std::optional<PointMerge> merge_of(const std::string& name) {
  if (name.empty()) return std::nullopt;
  if (name == "min") return PointMerge::kLowest;
  if (name == "max") return PointMerge::kHighest;
  return name == "first" ? PointMerge::kFirst : PointMerge::kMean;
}

ReturnChoice returns_of(const std::string& name) {
  if (name == "first") return ReturnChoice::kFirst;
  return name == "last" ? ReturnChoice::kLast : ReturnChoice::kAll;
}

/// Puts the options together.
void complete_options(BuildCommand& command) {
  BuildOptions& options = command.options;
  options.cost = cost_of(command.cost);
  options.duplicates = merge_of(command.duplicates);
  options.returns = returns_of(command.returns);
  if (!command.bbox.empty())
    options.bbox = {command.bbox[0], command.bbox[1], command.bbox[2], command.bbox[3]};
}

/// The same, and looks at the output; what their values may be is build()'s matter.
void check_command(BuildCommand& command) {
  const BuildOptions& options = command.options;
  if (command.inputs.empty() && !options.columns.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "no input; all that follows --columns names columns, so put INPUT before it");
  }
  if (command.inputs.empty() && !options.breaklines.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "no input; all that follows --breaklines are breaklines, so put INPUT before it");
  }
  complete_options(command);
  // An interrupted build may have been killed when its output had just got its name.
  const bool is_resumed =
      command.resume && is_there(Workspace::folder_of(output_target(command.output)));
  check_output(command.output, command.overwrite || is_resumed);
}

double ratio(double a, double b) { return b > 0 ? a / b : 0.0; }

/// How far merging moved a height, in steps between heights.
double height_steps(const BuildReport& r) {
  return ratio(r.largest_shift_height, r.height_quantum);
}

/// Points with heights far apart are hardly repeated ones: a mean of them may lie where no ground
/// is. Whoever named the rule knows that.
void warn_of_merging(const BuildCommand& command, const BuildReport& r, const Context& context) {
  constexpr double kManySteps = 100.0;
  if (command.options.duplicates || height_steps(r) <= kManySteps || context.json || context.quiet)
    return;
  std::fprintf(stderr,
               "ptin: warning: %s fell together with others, at heights up to %s (%s steps of %s) "
               "away from the mean that was taken; --duplicates min, max or first takes one of "
               "them, and of LAS --returns last leaves what lies near the ground\n",
               counted(r.merged_points, "point").c_str(),
               short_number(r.largest_shift_height).c_str(), short_number(height_steps(r)).c_str(),
               short_number(r.height_quantum).c_str());
}

/// Nothing can be asked of a terrain that is void everywhere.
void warn_of_no_surface(const BuildCommand& command, const BuildReport& r, const Context& context) {
  if (r.source_samples > r.lone_samples || context.json || context.quiet) return;
  const std::string why = r.source_samples == 0 ? "no sample of the source has a height"
                                                : "no sample with a height has a triangle";
  std::fprintf(
      stderr,
      "ptin: warning: %s has no surface, all of it is void: %s; look at the source, and at "
      "--nodata, --max-edge and --boundary\n",
      command.output.c_str(), why.c_str());
}

/// Where flat parts are this much of a file, it says how to leave them out.
constexpr double kMuchFlat = 0.2;

nlohmann::json report_json(const BuildCommand& command, const BuildReport& r,
                           const FlatRecords& flat) {
  return {{"output", command.output},
          {"samples", r.source_samples},
          {"void_samples", r.void_samples},
          {"lone_samples", r.lone_samples},
          {"left_out_points", r.left_out_points},
          {"left_out_triangles", r.left_out_triangles},
          {"void_triangles", r.void_triangles},
          {"merged_points", r.merged_points},
          {"largest_shift",
           {{"plan", r.largest_shift_plan},
            {"height", r.largest_shift_height},
            {"height_steps", height_steps(r)}}},
          {"height_rounding", r.height_rounding},
          {"vertices", r.vertices},
          {"records", r.records},
          {"t0_vertices", r.t0_vertices},
          {"rank", r.max_rank},
          {"bytes", r.file_bytes},
          {"source_bytes", r.source_bytes > 0 ? nlohmann::json(r.source_bytes) : nlohmann::json()},
          {"flat",
           {{"records", flat.records},
            {"bytes", flat.bytes},
            {"max_error", flat.max_error ? nlohmann::json(*flat.max_error) : nlohmann::json()}}},
          {"seconds", r.seconds}};
}

/// Commands that can be pasted.
void print_next(const BuildCommand& command) {
  const std::string out = shell_word(command.output);
  std::string verify = "ptin verify " + out + " --against";
  for (const std::string& input : command.inputs) verify.append(" ").append(shell_word(input));
  const BuildOptions& options = command.options;
  if (!options.breaklines.empty()) verify.append(" --breaklines");
  for (const std::string& path : options.breaklines) verify.append(" ").append(shell_word(path));
  if (!options.boundary.empty()) verify.append(" --boundary ").append(shell_word(options.boundary));
  std::printf("next: ptin info %s\n      ptin render %s -o picture.png\n      %s\n", out.c_str(),
              out.c_str(), verify.c_str());
}

/// The last lines: how large the file is, and how it would be smaller.
void print_size(const BuildCommand& command, const BuildReport& r, const FlatRecords& flat) {
  const auto bytes = static_cast<double>(r.file_bytes);
  std::printf("  size       %s, %.1f bytes a vertex", human_bytes(r.file_bytes).c_str(),
              ratio(bytes, static_cast<double>(r.t0_vertices + r.records)));
  if (r.source_bytes > 0) {
    std::printf(
        "; %s times the source's %s",
        short_number(std::round(ratio(bytes, static_cast<double>(r.source_bytes)) * 100) / 100)
            .c_str(),
        human_bytes(r.source_bytes).c_str());
  }
  std::printf("\n");
  const double share = ratio(static_cast<double>(flat.records), static_cast<double>(r.records));
  if (share < kMuchFlat || command.options.max_error > 0) return;
  std::printf(
      "  flat       %s of the records (%.0f %%, about %s) have error 0: built with --max-error %s\n"
      "             the file lacks them, and no sample differs\n",
      grouped(flat.records).c_str(), 100 * share, human_bytes(flat.bytes).c_str(),
      exact_number(*flat.max_error).c_str());
}

void print_report(const BuildCommand& command, const BuildReport& r, const FlatRecords& flat) {
  const char* out = command.output.c_str();
  std::printf("%s: %s\n", out, human_bytes(r.file_bytes).c_str());
  std::printf("  samples    %s with a height, %s void\n", grouped(r.source_samples).c_str(),
              grouped(r.void_samples).c_str());
  if (r.lone_samples > 0) {
    std::printf("  lone       %s without a triangle, treated as void\n",
                counted(r.lone_samples, "sample").c_str());
  }
  if (r.left_out_points > 0) {
    std::printf(
        "  left out   %s, by class or place, withheld, without a height, or in no triangle\n",
        counted(r.left_out_points, "point").c_str());
  }
  if (r.left_out_triangles + r.void_triangles > 0) {
    std::printf("  triangles  %s void ones fill holes and pockets; %s hidden ones left out\n",
                grouped(r.void_triangles).c_str(), grouped(r.left_out_triangles).c_str());
  }
  if (r.merged_points > 0) {
    std::printf("  merged     %s fell together (largest shift %s in plan, %s in height)\n",
                counted(r.merged_points, "point").c_str(),
                short_number(r.largest_shift_plan).c_str(),
                short_number(r.largest_shift_height).c_str());
  }
  if (r.height_rounding > 0)
    std::printf("  rounding   heights by at most %s\n", short_number(r.height_rounding).c_str());
  std::printf("  vertices   %s in the full TIN: %s in T0, %s in records\n",
              grouped(r.vertices).c_str(), grouped(r.t0_vertices).c_str(),
              grouped(r.records).c_str());
  std::printf("  rank       %u\n", unsigned{r.max_rank});
  std::printf("  speed      %s vertices/s, %.2f s\n",
              grouped(static_cast<std::uint64_t>(ratio(static_cast<double>(r.vertices), r.seconds)))
                  .c_str(),
              r.seconds);
  print_size(command, r, flat);
  print_next(command);
}

nlohmann::json plan_json(const BuildPlan& p) {
  return {{"tile", p.tile_side},
          {"tiles", p.leaves},
          {"levels", p.levels},
          {"vertices", p.vertices},
          {"threads", p.threads},
          {"memory_limit", p.memory.limit},
          {"memory_expected", p.memory_expected},
          {"temporary_bytes", p.temporary_bytes},
          {"output_bytes", p.output_bytes},
          {"free_bytes", p.output_free},
          {"estimated", p.is_estimate},
          {"seconds", p.seconds}};
}

/// One line of what is to come; a second one when less is used than was asked for.
void print_plan(const BuildPlan& p) {
  std::fprintf(stderr,
               "plan: %s%s in %s of %lld, %s, at most %s of memory, %s of "
               "temporary disk, %s of output, roughly %s\n",
               p.is_estimate ? "up to about " : "",
               counted(p.vertices, "vertex", "vertices").c_str(), counted(p.leaves, "tile").c_str(),
               static_cast<long long>(p.tile_side),
               counted(static_cast<std::uint64_t>(p.threads), "thread").c_str(),
               human_bytes(p.memory_expected).c_str(), human_bytes(p.temporary_bytes).c_str(),
               human_bytes(p.output_bytes).c_str(), human_duration(p.seconds).c_str());
  if (p.memory.limit > p.memory.allowed) {
    std::fprintf(stderr,
                 "plan: warning: --memory %s is more than the system lets this process have, %s\n",
                 human_bytes(p.memory.limit).c_str(), human_bytes(p.memory.allowed).c_str());
  }
  if (p.threads < p.threads_wanted) {
    std::fprintf(stderr, "plan: %s instead of %d, since no more tiles fit into %s\n",
                 counted(static_cast<std::uint64_t>(p.threads), "thread").c_str(), p.threads_wanted,
                 human_bytes(p.memory.limit).c_str());
  }
}

/// Big blocks go back to the system as soon as they are freed, so that the limit holds between
/// tiles too.
void return_freed_memory(int threads) {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
  mallopt(M_ARENA_MAX, threads + 1);
}

/// Where the limit leaves room for it, freed blocks are kept for the next tile: giving them back
/// and taking fresh ones, page by page, is a sixth of the time of a build.
void keep_freed_memory(const BuildPlan& plan) {
  constexpr std::uint64_t kKeptByThread = std::uint64_t{64} << 20;  // measured
  const std::uint64_t kept = kKeptByThread * static_cast<std::uint64_t>(plan.threads + 1);
  if (plan.memory_expected + kept <= plan.memory.limit) {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that malloc takes
    mallopt(M_TRIM_THRESHOLD, 32 << 20);
  }
}

/// What a run shows while it works.
class BuildShow final : public BuildObserver {
 public:
  BuildShow(const BuildCommand& command, const Context& context)
      : command_(command),
        context_(context),
        style_(Progress::style_for(context.quiet, stderr)),
        progress_(style_) {
    if (command.progress_fd >= 0) {
      std::signal(SIGPIPE, SIG_IGN);  // a reader may go away
      fd_.emplace(command.progress_fd);
    }
  }
  void plan(const BuildPlan& plan) override {
    finish();
    keep_freed_memory(plan);
    if (command_.dry_run && context_.json) {
      print_json(plan_json(plan));
    } else if (!context_.quiet) {
      print_plan(plan);
    }
  }
  void progress(const StageProgress& p) override {
    const auto now = std::chrono::steady_clock::now();
    if (stage_ != p.stage) {
      end_stage();
      stage_ = p.stage;
      begin_ = now;
      first_ = p.done;
    }
    facts_.tiles_done = p.tiles_done;
    facts_.tiles = p.tiles;
    if (now - looked_ > std::chrono::milliseconds(500)) {
      looked_ = now;
      facts_.memory = anonymous_bytes_now();
      most_memory_ = std::max(most_memory_, facts_.memory);
    }
    seconds_ = std::chrono::duration<double>(now - begin_).count();
    facts_.per_second =
        static_cast<std::uint64_t>(ratio(static_cast<double>(p.done - first_), seconds_));
    facts_.remaining_seconds =
        facts_.per_second > 0 && p.total >= p.done
            ? ratio(static_cast<double>(p.total - p.done), static_cast<double>(facts_.per_second))
            : -1.0;
    if (fd_) fd_->report(p.stage, p.done, p.total, facts_);
    progress_.report(p.stage, p.done, p.total, seconds_ > 1.0 && p.total > 1 ? detail() : "");
  }
  void give_back_memory() override { malloc_trim(0); }
  void finish() {
    end_stage();
    progress_.finish();
  }

 private:
  [[nodiscard]] std::string detail() const {
    const std::string tiles =
        facts_.tiles > 0 ? grouped(facts_.tiles_done) + " of " + grouped(facts_.tiles) + " tiles, "
                         : "";
    return tiles + rate() + human_bytes(facts_.memory);
  }
  /// Stages without tiles count in units of their own: bytes of text, samples, passes over points.
  [[nodiscard]] std::string rate() const {
    return facts_.tiles > 0 ? grouped(facts_.per_second) + " vertices/s, " : "";
  }
  /// Where lines stay, a stage that took a while says what it came to.
  void end_stage() {
    if (!stage_.empty() && style_ == Progress::Style::kSparse && seconds_ > 1.0) {
      progress_.finish();
      std::fprintf(stderr, "  %s%sat most %s of memory so far\n",
                   facts_.tiles > 0 ? (counted(facts_.tiles, "tile") + ", ").c_str() : "",
                   rate().c_str(), human_bytes(most_memory_).c_str());
    }
    stage_.clear();
    facts_.tiles = facts_.tiles_done = 0;
  }

  const BuildCommand& command_;
  const Context& context_;
  Progress::Style style_;
  Progress progress_;
  std::optional<ProgressFd> fd_;
  std::string stage_;
  std::chrono::steady_clock::time_point begin_{}, looked_{};
  std::uint64_t first_ = 0, most_memory_ = 0;
  double seconds_ = 0.0;
  ProgressFacts facts_;
};

BuildResources resources_of(const BuildCommand& command, const Context& context,
                            BuildObserver& show) {
  BuildResources resources;
  resources.overwrite = command.overwrite;
  resources.stop = context.stop;
  if (!command.memory.empty()) resources.memory_bytes = parse_bytes(command.memory, "--memory");
  resources.threads = command.threads;
  resources.tmp = command.tmp;
  resources.unfinished = command.resume    ? Unfinished::kResume
                         : command.discard ? Unfinished::kDiscard
                                           : Unfinished::kRefuse;
  resources.dry_run = command.dry_run;
  resources.observer = &show;
  return resources;
}

/// The report, in text or JSON.
void tell(const BuildCommand& command, const BuildReport& report, const Context& context) {
  warn_of_merging(command, report, context);
  warn_of_no_surface(command, report, context);
  if (!context.json && context.quiet) return;
  const FlatRecords flat =
      flat_records(*StoreFile::open(output_target(command.output), PageAccess::kPread));
  if (context.json) {
    print_json(report_json(command, report, flat));
  } else {
    print_report(command, report, flat);
  }
}

/// True where this process is one of several that were started together, by mpirun or srun.
bool is_started_with_others() {
  const char* const ranks = std::getenv("OMPI_COMM_WORLD_SIZE");
  return (ranks != nullptr && std::string(ranks) != "1") || std::getenv("PMIX_RANK") != nullptr;
}

/// The processes that build with this one; null where it is alone.
std::unique_ptr<BuildCluster> cluster_of(const Context& context) {
  if (!is_started_with_others()) return nullptr;
  if (!context.join_cluster) {
    throw Error(ErrorCode::invalid_argument,
                "this ptin was made without MPI, so each of the processes would build by itself; make "
                "it with -D PTIN_MPI=ON, or start it without mpirun");
  }
  return context.join_cluster();
}

/// What a process does that another one directs: tasks, one at a time, without a word.
int work_in_cluster(BuildCommand& command, const Context& context, BuildCluster& cluster) {
  complete_options(command);
  return_freed_memory(1);
  install_sigbus_guard();
  Context silent = context;
  silent.quiet = true;
  command.progress_fd = -1;
  BuildShow show(command, silent);
  cluster.work(command.inputs, command.options, resources_of(command, context, show));
  return kExitDone;
}

int run_build(BuildCommand& command, const Context& context) {
  if (command.discard && command.inputs.empty()) {
    const bool found = Workspace::discard(FileLayer::system(), output_target(command.output));
    if (context.json) {
      print_json({{"output", command.output}, {"discarded", found}});
    } else if (!context.quiet) {
      std::printf(
          found ? "%s: the unfinished build is removed\n" : "%s: there is no unfinished build\n",
          command.output.c_str());
    }
    return found ? kExitDone : kExitNegative;
  }
  const std::unique_ptr<BuildCluster> cluster = cluster_of(context);
  if (cluster && !cluster->directs()) return work_in_cluster(command, context, *cluster);
  check_command(command);
  return_freed_memory(thread_count(command.threads));
  install_sigbus_guard();  // a temporary file that loses bytes is an error, not the end
  BuildReport report;
  {
    BuildShow show(command, context);
    BuildResources resources = resources_of(command, context, show);
    if (cluster) resources.driver = cluster->driver();
    report = build(command.inputs, output_target(command.output), command.options, resources);
    show.finish();
  }
  if (!report.left_behind.empty()) {
    std::fprintf(stderr, "ptin build: the output is complete; what is left behind: %s\n",
                 report.left_behind.c_str());
  }
  if (command.dry_run) return kExitDone;
  try {
    tell(command, report, context);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::resource_exhausted,
                "the file is complete, but the system gives no memory for the report of it",
                command.output);
  }
  return kExitDone;
}

/// What is read, and what of it.
void add_source_options(CLI::App& app, BuildCommand& command) {
  BuildOptions& options = command.options;
  app.add_option(
      "INPUT", command.inputs,
      "A raster that GDAL reads, several of one grid, or points: LAS, CSV or XYZ text (.gz\n"
      "too), or a layer that OGR reads; several files of one CRS; or a TIN: PLY, OBJ, 2DM, "
      "LandXML");
  app.add_option("--nodata", options.nodata,
                 "This stored value (before scale and offset) means void; overrides the source's")
      ->type_name("V");
  app.add_option("--resolution", options.resolution, "Points, TINs: the grid unit, in CRS units")
      ->check(numbers(NumberRange::kPositive, "in CRS units"))
      ->type_name("R");
  app.add_option("--class", options.classes,
                 "LAS: keep points of these classes, such as 2 for ground; 2,9 for several")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("N");
  app.add_option("--returns", command.returns,
                 "LAS: keep the last return of each pulse (near the ground), the first, or all\n"
                 "(default)")
      ->check(CLI::IsMember({"all", "first", "last"}))
      ->type_name("WHICH");
  app.add_option("--duplicates", command.duplicates,
                 "Points, --repair: the height of those that fall together: mean (default), min, "
                 "max, or\n"
                 "first (of the first input that has one)")
      ->check(CLI::IsMember({"mean", "min", "max", "first"}))
      ->type_name("RULE");
  app.add_option("--layer", options.layer, "Points of this layer, where a file holds several")
      ->type_name("NAME");
  app.add_option("--columns", options.columns,
                 "Text: the names of its columns from the left; x, y, z or as a header may name\n"
                 "them, by any other name columns that are passed over (default: a header's, else "
                 "x y z)")
      ->delimiter(',')
      ->type_name("NAME");
  app.add_option("--z-field", options.z_field,
                 "The attribute that holds the height of a layer's points (default: their z)")
      ->type_name("NAME");
  app.add_flag("--repair", options.repair,
               "TINs: leave the triangles and triangulate the vertices anew; voids by --max-edge");
  app.add_option("--max-edge", options.max_edge,
                 "Points, --repair: triangles with an edge longer than this become void; CRS "
                 "units, or metres\n"
                 "where those are degrees")
      ->check(numbers(NumberRange::kPositive, "in CRS units, or metres where those are degrees"))
      ->type_name("L");
  app.add_option("--breaklines", options.breaklines,
                 "Points, --repair: lines with heights that become edges of the TIN, from layers "
                 "that OGR\n"
                 "reads or LandXML; several files, behind INPUT")
      ->type_name("FILE");
  app.add_option("--breakline-layer", options.breakline_layer,
                 "Breaklines of this layer, where a file holds several")
      ->type_name("NAME");
  app.add_option("--boundary", options.boundary,
                 "Points, --repair: polygons outside of which all is void, from a layer that OGR "
                 "reads or\n"
                 "LandXML; without heights they are laid on the surface")
      ->type_name("FILE");
  app.add_option("--boundary-layer", options.boundary_layer,
                 "The boundary is this layer, where its file holds several")
      ->type_name("NAME");
  app.add_option("--bbox", command.bbox, "Leave out samples outside of this box, in CRS units")
      ->expected(4)
      ->check(numbers(NumberRange::kFinite, "in CRS units"))
      ->type_name("XMIN YMIN XMAX YMAX");
  app.add_option("--a-srs,--a_srs", options.a_srs,
                 "The CRS; overrides the source's (EPSG code, WKT, PROJ string)")
      ->type_name("CRS");
  app.add_option("--vertical-crs", options.vertical_crs, "The vertical CRS, as EPSG:5773")
      ->type_name("CRS");
}

/// The work: its tiles, memory, threads and temporary files, and whether it goes on.
void add_work_options(CLI::App& app, BuildCommand& command) {
  app.add_option(
         "--tile", command.options.tile,
         "Samples along a leaf of the tile hierarchy, of points and TINs about as many (default:\n"
         "by the number of samples)")
      ->type_name("SIDE");
  app.add_option("--memory", command.memory,
                 "Hard limit on the memory of the process, as 512M or 2G (default: 1G, or less\n"
                 "where a cgroup or a resource limit allows less)")
      ->type_name("SIZE");
  app.add_option(
         "--threads", command.threads,
         "Threads (default: one a processor that affinity and cgroups leave this process);\n"
         "fewer are used where memory is short. The output is the same for any number")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  app.add_option("--tmp", command.tmp, "Folder for temporary files (default: beside the output)")
      ->check(CLI::ExistingDirectory)
      ->type_name("DIR");
  auto* resume = app.add_flag("--resume", command.resume, "Go on with an interrupted build");
  app.add_flag("--discard", command.discard,
               "Remove an interrupted build first; without INPUT, only that")
      ->excludes(resume);
  app.add_flag("--dry-run", command.dry_run, "Say what the build would need, and stop");
  app.add_option("--progress-fd", command.progress_fd,
                 "Write progress as lines of JSON to this file descriptor")
      ->check(numbers(NumberRange::kNotNegative, ""))
      ->type_name("FD");
}

}  // namespace

Action declare_build(CLI::App& app, Context& context) {
  const auto command = std::make_shared<BuildCommand>();
  BuildOptions& options = command->options;
  add_source_options(app, *command);
  app.add_option("-o,--output", command->output, "The .ptin file to write")
      ->type_name("FILE")
      ->required();
  app.add_option("--cost", command->cost,
                 "In which order vertices go: error (default, for levels of detail), roi (point\n"
                 "location) or elevation (isolines)")
      ->check(CLI::IsMember({"error", "roi", "elevation"}));
  app.add_option("--max-error", options.max_error,
                 "Leave out detail below this error, in the height's unit")
      ->check(numbers(NumberRange::kNotNegative, "in the height's unit"))
      ->type_name("E");
  app.add_option(
         "--void-slope", options.void_slope,
         "Error charged for each ground unit that the border of a void moves: at an error E it\n"
         "moves by E / S at most")
      ->check(numbers(NumberRange::kNotNegative, ""))
      ->type_name("S")
      ->capture_default_str();
  add_work_options(app, *command);
  app.add_flag("--overwrite", command->overwrite, "Replace an existing output");
  return [command, &context] { return run_build(*command, context); };
}

}  // namespace ptin::tools
