// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/build_show.h"

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "engine/construct/memory_plan.h"
#include "tools/facts/human.h"
#include "tools/kept_memory.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

nlohmann::json json_of(const BuildPlan& p) {
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
               "temporary disk and %s of output, roughly %s\n",
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

}  // namespace

BuildShow::BuildShow(const BuildCommand& command, const Context& context)
    : command_(command),
      context_(context),
      style_(Progress::style_for(context.quiet, stderr)),
      progress_(style_) {
  if (command.progress_fd >= 0) {
    std::signal(SIGPIPE, SIG_IGN);  // a reader may go away
    fd_.emplace(command.progress_fd);
  }
}

void BuildShow::plan(const BuildPlan& plan) {
  finish();
  keep_freed_memory(plan);
  plan_ = json_of(plan);
  if (!context_.quiet && !(command_.dry_run && context_.json)) {
    print_plan(plan);
  }
}

void BuildShow::progress(const StageProgress& p) {
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

void BuildShow::give_back_memory() { give_back_freed_memory(); }

void BuildShow::finish() {
  end_stage();
  progress_.finish();
}

std::string BuildShow::detail() const {
  const std::string tiles =
      facts_.tiles > 0 ? grouped(facts_.tiles_done) + " of " + grouped(facts_.tiles) + " tiles, "
                       : "";
  return tiles + rate() + human_bytes(facts_.memory);
}
/// Stages without tiles count in units of their own: bytes of text, samples, passes over points.

std::string BuildShow::rate() const {
  return facts_.tiles > 0 ? grouped(facts_.per_second) + " vertices/s, " : "";
}
/// Where lines stay, a stage that took a while says what it came to.

void BuildShow::end_stage() {
  if (!stage_.empty() && style_ == Progress::Style::kSparse && seconds_ > 1.0) {
    progress_.finish();
    std::fprintf(stderr, "  %s%sat most %s of memory so far\n",
                 facts_.tiles > 0 ? (counted(facts_.tiles, "tile") + ", ").c_str() : "",
                 rate().c_str(), human_bytes(most_memory_).c_str());
  }
  stage_.clear();
  facts_.tiles = facts_.tiles_done = 0;
}

BuildResources resources_of(const BuildCommand& command, const Context& context,
                            BuildObserver& show) {
  BuildResources resources;
  resources.overwrite = command.overwrite;
  resources.stop = context.stop;
  if (!command.memory.empty()) resources.memory_bytes = parse_memory(command.memory, "--memory");
  resources.threads = command.threads;
  resources.tmp = command.tmp;
  resources.unfinished = command.resume    ? Unfinished::kResume
                         : command.discard ? Unfinished::kDiscard
                                           : Unfinished::kRefuse;
  resources.dry_run = command.dry_run;
  resources.observer = &show;
  return resources;
}

}  // namespace ptin::tools
