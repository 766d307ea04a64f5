// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin build: from a source to a .ptin file, with a report.
#include "engine/construct/build.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/memory_plan.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "storage/file/sigbus_guard.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/kept_memory.h"
#include "tools/output/output_file.h"
#include "tools/ptin/build_cluster.h"
#include "tools/ptin/build_command.h"
#include "tools/ptin/build_show.h"
#include "tools/ptin/build_warnings.h"
#include "tools/ptin/error_stats.h"
#include "tools/ptin/left_out_points.h"
#include "tools/ptin/parts_plan.h"
#include "tools/ptin/query_options.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

/// Puts the options together and looks at the output; what their values may be is build()'s matter.
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
  // An interrupted build may have been killed when its output had just got its name.
  const bool is_resumed =
      command.resume && is_there(Workspace::folder_of(output_target(command.output)));
  check_output(command.output, command.overwrite || is_resumed);
}

/// How far merging moved a height, in steps between heights.
double height_steps(const BuildReport& r) {
  return ratio(r.largest_shift_height, r.height_quantum);
}

/// Where flat parts are this much of a file, it says how to leave them out.
constexpr double kMuchFlat = 0.2;

nlohmann::json report_json(const BuildCommand& command, const BuildReport& r,
                           const FlatRecords& flat) {
  return {{"output", command.output},
          {"samples", r.source_samples},
          {"void_samples", r.void_samples},
          {"lone_samples", r.lone_samples},
          {"left_out_points", r.left_out.total()},
          {"left_out", left_out_json(r.left_out)},
          {"empty_inputs", r.empty_inputs},
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
  if (r.left_out.total() > 0) {
    std::printf("  left out   %s: %s\n", counted(r.left_out.total(), "point").c_str(),
                reasons_text(r.left_out).c_str());
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

/// The report, in text or JSON.
void tell(const BuildCommand& command, const BuildReport& report, const Context& context) {
  const SourceWarnings warnings = build_warnings(command, report);
  print_warnings(warnings, context);
  if (!context.json && context.quiet) return;
  const FlatRecords flat =
      flat_records(*StoreFile::open(output_target(command.output), PageAccess::kPread));
  if (context.json) {
    nlohmann::json json = report_json(command, report, flat);
    json["warnings"] = warnings_json(warnings);
    print_json(json);
  } else {
    print_report(command, report, flat);
  }
}

/// True where this process is one of several that were started together, by mpirun or srun. Both set
/// PMIX_RANK for a single one, too.
bool is_started_with_others() {
  const auto are_several = [](const char* number) { return std::string(number) != "1"; };
  if (const char* const ranks = std::getenv("OMPI_COMM_WORLD_SIZE")) return are_several(ranks);
  if (std::getenv("PMIX_RANK") == nullptr) return false;
  const char* const tasks = std::getenv("SLURM_STEP_NUM_TASKS");
  return tasks == nullptr || are_several(tasks);
}

/// The processes that build with this one; null where it is alone.
std::unique_ptr<BuildCluster> cluster_of(const Context& context) {
  if (!is_started_with_others()) return nullptr;
  if (!context.join_cluster) {
    throw Error(
        ErrorCode::invalid_argument,
        "this ptin was made without MPI, so each of the processes would build by itself; make "
        "it with -D PTIN_MPI=ON, or start it without mpirun");
  }
  return context.join_cluster();
}

/// What a process does that another one directs: tasks, one at a time, without a word.
int work_in_cluster(BuildCommand& command, const Context& context, BuildCluster& cluster) {
  return_freed_memory(1);
  install_sigbus_guard();
  Context silent = context;
  silent.quiet = true;
  command.progress_fd = -1;
  BuildShow show(command, silent);
  BuildResources resources = resources_of(command, context, show);
  resources.patience = kPatience;
  cluster.work(command.inputs, command.options, resources);
  return kExitDone;
}

/// Reads the source, and writes the plan for those who do the rest.
int plan_in_parts(const BuildCommand& command, const BuildResources& resources,
                  const Context& context, BuildShow& show) {
  const SourceWarnings warnings = write_parts_plan(command, context.arguments, resources);
  show.finish();
  print_warnings(warnings, context);
  if (context.json) {
    print_json(
        {{"plan", command.plan}, {"parts", command.parts}, {"warnings", warnings_json(warnings)}});
  } else if (!context.quiet) {
    const std::string plan = shell_word(command.plan);
    const int last = command.parts - 1;
    std::printf(
        "%s: %d parts. Each phase begins when all jobs of the one before are done:\n"
        "  ptin build-part %s collapse N    for N from 0 to %d\n  ptin build-part %s join\n"
        "  ptin build-part %s tighten N     for N from 0 to %d\n  ptin build-part %s publish\n",
        command.plan.c_str(), command.parts, plan.c_str(), last, plan.c_str(), plan.c_str(), last,
        plan.c_str());
  }
  return kExitDone;
}

/// Tells what a dry run came to; its plan is printed in words as soon as it is made.
int tell_plan(const BuildReport& report, const Context& context, const BuildShow& show) {
  print_warnings(report.warnings, context);
  if (context.json) {
    nlohmann::json json = show.plan_json();
    json["warnings"] = warnings_json(report.warnings);
    print_json(json);
  }
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
    if (command.parts > 0) return plan_in_parts(command, resources, context, show);
    if (cluster) resources.driver = cluster->driver();
    report = build(command.inputs, output_target(command.output), command.options, resources);
    show.finish();
    if (command.dry_run) return tell_plan(report, context, show);
  }
  if (!report.left_behind.empty()) {
    std::fprintf(stderr, "ptin build: the output is complete; what is left behind: %s\n",
                 report.left_behind.c_str());
  }
  try {
    tell(command, report, context);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::resource_exhausted,
                "the file is complete, but the system gives no memory for the report of it",
                command.output);
  }
  return kExitDone;
}

}  // namespace

Declared declare_build(Context& context) {
  const auto command = std::make_shared<BuildCommand>();
  return {build_rows(*command), [command, &context] { return run_build(*command, context); }};
}

}  // namespace ptin::tools
