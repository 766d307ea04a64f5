// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin build-part: one job of a build in parts.
#include <cstdio>
#include <filesystem>

#include "engine/construct/build_parts.h"
#include "engine/error.h"
#include "storage/file/sigbus_guard.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/kept_memory.h"
#include "tools/output/output_file.h"
#include "tools/ptin/build_show.h"
#include "tools/ptin/build_warnings.h"
#include "tools/ptin/command.h"
#include "tools/ptin/parts_plan.h"
#include "tools/ptin/query_options.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct PartCommand {
  std::string plan, phase;
  int part = -1;
  std::string memory;
  int threads = 0;
};

int publish(const PartsPlan& plan, const BuildResources& resources, const Context& context) {
  const BuildReport report = publish_parts(plan.command.inputs, output_target(plan.command.output),
                                           plan.command.options, resources, plan.command.parts);
  if (context.json) {
    print_json({{"output", plan.command.output},
                {"records", report.records},
                {"bytes", report.file_bytes},
                {"warnings", warnings_json(report.warnings)}});
  } else if (!context.quiet) {
    std::printf("%s: %s, %s records\n", plan.command.output.c_str(),
                human_bytes(report.file_bytes).c_str(), grouped(report.records).c_str());
  }
  return kExitDone;
}

/// Only the phases of several parts take a number.
int part_of(const PartCommand& command) {
  const bool is_numbered = command.phase == "collapse" || command.phase == "tighten";
  if (is_numbered != (command.part >= 0)) {
    throw Error(ErrorCode::invalid_argument,
                is_numbered ? "the phase " + command.phase + " has parts; give the number of one"
                            : "the phase " + command.phase + " is one job; give no number");
  }
  return is_numbered ? command.part : 0;
}

int run_build_part(const PartCommand& command, const Context& context) {
  const int part = part_of(command);
  PartsPlan plan = read_parts_plan(command.plan);
  std::error_code failure;
  std::filesystem::current_path(plan.folder, failure);
  if (failure) {
    throw Error(ErrorCode::not_found, "the folder in which the build was planned is not here",
                plan.folder);
  }
  BuildCommand& build = plan.command;
  if (!command.memory.empty()) build.memory = command.memory;
  build.threads = thread_count(command.threads);
  return_freed_memory(build.threads);
  install_sigbus_guard();
  BuildShow show(build, context);
  BuildResources resources = resources_of(build, context, show);
  resources.patience = kPatience;
  if (command.phase == "publish") {
    const int status = publish(plan, resources, context);
    show.finish();
    return status;
  }
  const PartsPhase phase = command.phase == "collapse" ? PartsPhase::kCollapse
                           : command.phase == "join"   ? PartsPhase::kJoin
                                                       : PartsPhase::kTighten;
  do_part(build.inputs, build.options, resources, plan.note, phase, part, build.parts);
  if (context.json) {
    print_json({{"phase", command.phase}, {"part", part}});
  } else if (!context.quiet) {
    std::printf("%s %d: done\n", command.phase.c_str(), part);
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, PartCommand& command) {
  rows.add("plan", &command.plan, "", "The plan that `ptin build --parts` wrote")
      .spelled("PLAN")
      .required_at(ask::Door::kBoth);
  rows.add("phase", &command.phase, "", "What to do: collapse, join, tighten or publish")
      .spelled("PHASE")
      .of({"collapse", "join", "tighten", "publish"})
      .required_at(ask::Door::kBoth);
  rows.add("part", &command.part, "N", "Which part, from 0; of collapse and tighten")
      .spelled("PART")
      .within({.least = 0, .most = 1 << 20});
  rows.add("memory", &command.memory, "SIZE",
           "Limit on the memory of this job (default: that of the plan)");
  ask::add_threads(rows, command.threads, "Threads of this job (default: one a processor)");
}

}  // namespace

Declared declare_build_part(Context& context) {
  return declared<PartCommand>(context, run_build_part);
}

}  // namespace ptin::tools
