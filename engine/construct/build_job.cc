// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_job.h"

#include <algorithm>
#include <filesystem>
#include <new>
#include <string>

#include <sys/stat.h>

#include "engine/construct/build_option_table.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/points/point_portions.h"
#include "engine/construct/process_limits.h"
#include "engine/construct/source_files.h"
#include "engine/construct/store_output.h"
#include "engine/construct/tile_tasks/build_hierarchy.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin::build_internal {

namespace {

/// The version of the temporary files: raised when their bytes mean something else.
constexpr int kTemporaryFormat = 10;

/// The key of a line of the manifest: the sorted source that an earlier line names is damaged.
constexpr const char* kIsForgotten = "source_is_damaged";

/// The number of a file on its disk, which stays the same when it gets another name; none when
/// there is no such file.
std::optional<std::uint64_t> inode_of(const std::string& path) {
  struct stat s {};
  return ::stat(path.c_str(), &s) == 0 ? std::optional<std::uint64_t>(s.st_ino) : std::nullopt;
}

/// True when this build, or the interrupted one that it goes on with, had got as far as giving the
/// output its name. Its pages may still have theirs, too (FileLayer::rename).
bool is_published(const Job& job, const Workspace& workspace) {
  if (job.inode_of_output) {
    return inode_of(job.output) == job.inode_of_output;
  }
  const std::vector<nlohmann::json> lines = workspace.lines();
  const auto last = std::find_if(lines.rbegin(), lines.rend(), [](const nlohmann::json& line) {
    return line.contains("publishing");
  });
  return last != lines.rend() && inode_of(job.output) == (*last)["publishing"].get<std::uint64_t>();
}

void report_published(Job& job) {
  const auto store = StoreFile::open(job.output);
  job.report.source_samples = store->facts().source_samples;
  job.report.vertices = store->record_count() + store->t0().vertices.size();
  job.report.records = store->record_count();
  job.report.t0_vertices = store->t0().vertices.size();
  job.report.max_rank = store->max_rank();
  job.report.file_bytes = bytes_of_file(job.output);
}

/// True where faults of the system are worth keeping the folder for. Other processes may still write
/// into it then: it cannot be removed under them.
bool is_shared_fault(const Job& job, ErrorCode code) {
  return job.resources.driver != nullptr &&
         (code == ErrorCode::cancelled || code == ErrorCode::resource_exhausted ||
          code == ErrorCode::io_error);
}

/// True for files of tasks and of sorting, which are made again. The pages of the output are not: they
/// are of work whose files are gone.
bool is_made_again(const Workspace& workspace, const std::string& path) {
  return path.starts_with(workspace.temporary_folder() + "/") &&
         !path.starts_with(pages_file_in(workspace.folder())) &&
         !path.starts_with(workspace.folder() + "/descriptors");
}

constexpr const char* kGoOn = ": go on by --resume, or remove it by --discard";
constexpr const char* kSortAgain =
    ": go on by --resume, which reads the source again, or remove it by --discard";
constexpr const char* kStartAgain = ", and cannot be gone on with: start again after --discard";

Error with_advice(const Error& error, const std::string& folder, const char* advice) {
  return {error.code(), error.message() + "; what is done is kept in " + folder + advice,
          error.context()};
}

/// The error, with the work that is kept added to its text. This stays of use where a sorted source
/// is damaged.
Error error_with_work(Workspace& workspace, const Job& job, const Error& error) {
  if (!is_lost_sorted_source(error, workspace.temporary_folder())) {
    const bool is_over = job.inputs_changed || (error.code() == ErrorCode::corruption &&
                                                !is_made_again(workspace, error.context()));
    return with_advice(error, workspace.folder(), is_over ? kStartAgain : kGoOn);
  }
  try {
    forget_index(workspace);
  } catch (...) {  // who goes on meets the damage again, and notes it then
  }
  return with_advice(error, workspace.folder(), kSortAgain);
}

/// Removes what a failed build began, and throws its error on, whatever becomes of that.
[[noreturn]] void give_up(Workspace& workspace, const Error& error) {
  const std::string folder = workspace.folder();
  std::string left;
  try {
    workspace.remove_all();
  } catch (const Error& e) {
    left = "; and " + folder + " could not be removed: " + e.message();
  }
  throw Error(error.code(), error.message() + left, error.context());
}

/// Removes what a complete build needs no more. The output is complete whatever becomes of that.
void remove_done(Workspace& workspace, Job& job) {
  try {
    try {
      workspace.remove_all();
    } catch (const std::bad_alloc&) {
      workspace.remove_all();  // by now the build's own memory is free
    }
  } catch (...) {
    job.report.left_behind = error_in_flight().what();
  }
}

Error unexpected(const std::string& what) {
  return {ErrorCode::internal, "something else than an error of ours was thrown: " + what};
}

}  // namespace

Error error_in_flight() {
  try {
    throw;
  } catch (const Error& e) {
    return e;
  } catch (const std::bad_alloc&) {
    return {ErrorCode::resource_exhausted,
            "the system gives no more memory; give a lower --memory, or close other programs"};
  } catch (const std::filesystem::filesystem_error& e) {
    return system_error(e.code().value(), "the file system refused", e.path1().string());
  } catch (const std::system_error& e) {
    if (e.code() != std::errc::resource_unavailable_try_again) return unexpected(e.what());
    return {ErrorCode::resource_exhausted,
            "the system gives no more threads; give fewer --threads, or close other programs"};
  } catch (const std::exception& e) {
    return unexpected(e.what());
  } catch (...) {
    return {ErrorCode::internal,
            "something was thrown that is no exception of the standard library"};
  }
}

Error with_resume_hint(const Error& error, const std::string& folder) {
  return with_advice(error, folder, kGoOn);
}

FileLayer& Job::files() const {
  return resources.files != nullptr ? *resources.files : FileLayer::system();
}

TileBytes tile_bytes_of(InputKind kind) noexcept {
  return kind == InputKind::kRaster ? TileBytes{} : TileBytes{.replay_of_sample = 560};
}

PlanRequest Job::plan_request(const SourceDisk& disk) const {
  return {output, options, resources, memory, tile_bytes_of(memory.kind), disk};
}

void Job::tell(const BuildPlan& plan) const {
  if (resources.observer != nullptr) {
    resources.observer->plan(plan);
  }
}

void Job::tell(const StageProgress& progress) const {
  if (resources.observer != nullptr) {
    resources.observer->progress(progress);
  }
}

RunTasks Job::run_tasks() const {
  return [this](TaskList& tasks, TaskWorker& worker) {
    const int wanted = resources.threads > 0 ? resources.threads : allowed_threads();
    // No tile is in work yet: what is left for tiles is there for these tasks.
    const std::uint64_t fit =
        memory.for_tiles(anonymous_bytes_now(), wanted) / std::max<std::uint64_t>(tasks.bytes(), 1);
    const std::uint64_t most =
        std::clamp<std::uint64_t>(tasks.left(), 1, static_cast<std::uint64_t>(wanted));
    const int threads = static_cast<int>(std::clamp<std::uint64_t>(fit, 1, most));
    tasks.set_bytes(memory.sorting / static_cast<std::uint64_t>(threads));
    tasks.tell([this](const StageProgress& progress) { tell(progress); });
    TaskDriver here;
    (resources.driver != nullptr ? *resources.driver : here)
        .run(tasks, worker, {threads}, resources.stop);
  };
}

bool Job::begin(const nlohmann::json& index, const Workspace* workspace) const {
  return resources.driver == nullptr ||
         resources.driver->begin({index, workspace == nullptr ? "" : workspace->folder(),
                                  workspace == nullptr ? "" : workspace->temporary_folder(),
                                  input_fingerprint(all_inputs(inputs, options))});
}

SourceOptions Job::source_options() const {
  SourceOptions source = source_options_of(options);
  source.lines = &lines;
  return source;
}

std::vector<std::string> all_inputs(const std::vector<std::string>& inputs,
                                    const BuildOptions& options) {
  std::vector<std::string> all = inputs;
  all.insert(all.end(), options.breaklines.begin(), options.breaklines.end());
  if (!options.boundary.empty()) {
    all.push_back(options.boundary);
  }
  return all;
}

std::string Job::sorting_folder(const Workspace& workspace) const {
  return resources.driver != nullptr && !resources.tmp.empty() ? resources.tmp
                                                               : workspace.temporary_folder();
}

nlohmann::json fingerprint(const Job& job) {
  return {{"options", options_json(job.options)},
          {"page_bytes", job.options.page_bytes},
          {"inputs", input_fingerprint(all_inputs(job.inputs, job.options))},
          {"program", {PTIN_VERSION, kTemporaryFormat}}};
}

void plan_before_reading(const Job& job,
                         const std::function<SourceDisk(const PointCount&)>& disk_of) {
  const PointCount count = count_points(job.inputs, job.source_options());
  if (!count.is_known) {
    if (job.resources.dry_run) {
      throw Error(ErrorCode::invalid_argument,
                  "how much a build from a pipe needs is not known before it is read");
    }
    return;
  }
  SourceDisk disk = disk_of(count);
  disk.is_estimate = true;
  disk.may_be_less = count.may_be_less;
  job.tell(plan_build(TileTree::over_points(count.points, job.options.tile, nullptr),
                      job.plan_request(disk)));
}

void in_workspace(Job& job, const nlohmann::json& fingerprint,
                  const std::function<void(Workspace&)>& work) {
  Workspace workspace(job.files(), job.output, job.exchange_folder(), job.resources.unfinished,
                      fingerprint);
  job.report.resumed = !workspace.lines().empty();
  job.report.source_bytes = bytes_in(fingerprint.at("inputs"));
  job.began_with = fingerprint.at("inputs");
  if (is_published(job, workspace)) {  // its source may be gone by now, and is not wanted
    report_published(job);
    remove_done(workspace, job);
    return;
  }
  try {
    work(workspace);
  } catch (...) {
    const Error e = error_in_flight();
    if (e.code() == ErrorCode::resource_exhausted && is_published(job, workspace)) {
      report_published(job);  // only reporting it failed
      remove_done(workspace, job);
      return;
    }
    if (workspace.has_work() || is_shared_fault(job, e.code())) {
      throw error_with_work(workspace, job, e);
    }
    give_up(workspace, e);
  }
  if (!job.goes_on_elsewhere) {
    remove_done(workspace, job);
  }
}

HierarchyOptions hierarchy_options(const Job& job, const TiledSource& source,
                                   const BuildPlan& plan) {
  HierarchyOptions options;
  options.collapse = collapse_options(job.options, source);
  options.threads = plan.threads;
  options.memory = {plan.tile_bytes, plan.memory_for_tiles, plan.memory.gdal_cache};
  options.give_back = [&job](std::uint64_t bytes) {
    // Memory that is given back is taken again a page at a time: a fifth of the time, where it
    // happens before every larger piece.
    if (job.resources.observer != nullptr && anonymous_bytes_now() + bytes > job.memory.limit) {
      job.resources.observer->give_back_memory();
    }
  };
  options.checkpoint_interval = job.resources.checkpoint_interval;
  options.driver = job.resources.driver;
  options.stop = job.resources.stop;
  options.progress = [&job](const StageProgress& progress) { job.tell(progress); };
  return options;
}

namespace {

/// Refuses to publish what was read of inputs that are others now: what is in the file may be of both.
/// Inputs that can be read only once are not looked at again.
void require_unchanged(Job& job) {
  const std::vector<std::string> all = all_inputs(job.inputs, job.options);
  if (std::any_of(all.begin(), all.end(), can_be_read_once_only)) {
    return;
  }
  const nlohmann::json now = input_fingerprint(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const nlohmann::json &before = job.began_with.at(i).at(1), &files = now.at(i).at(1);
    for (const nlohmann::json& file : before) {
      if (std::find(files.begin(), files.end(), file) == files.end()) {
        job.inputs_changed = true;
        throw Error(ErrorCode::invalid_argument, "this file changed while the build read it",
                    file.at(0).get<std::string>());
      }
    }
    for (const nlohmann::json& file : files) {
      if (std::find(before.begin(), before.end(), file) == before.end()) {
        throw Error(ErrorCode::invalid_argument,
                    "this file appeared beside an input while the build read that; where it means "
                    "nothing for heights, as statistics do, remove it first",
                    file.at(0).get<std::string>());
      }
    }
  }
}

}  // namespace

void build_tiles(Workspace& workspace, Job& job, const TiledSource& source, const BuildPlan& plan,
                 const nlohmann::json& index) {
  StoreOutput store(job.output, job.options, job.resources.overwrite, source.frame,
                    static_cast<bool>(source.add_floor), job.files(), workspace.folder());
  if (!job.begin(index, &workspace)) {
    job.goes_on_elsewhere = true;
    // Hours of work will be in the folder, of which its manifest does not know: no error may remove
    // it.
    workspace.append({{{"elsewhere", true}}});
    return;
  }
  const BuiltHierarchy built = build_hierarchy(
      source.make_starter, source.tree, hierarchy_options(job, source, plan), workspace, store);
  job.report.lone_samples = built.lone_samples;
  job.tell(StageProgress{"writing", 0, 1});
  if (source.add_floor) {
    store.add_floor(
        [&](StoreWriter& writer) { return source.add_floor(writer, job.resources.stop); });
  }
  require_unchanged(job);  // the heights are read once more, and have to be those of the records
  const std::uint64_t inode = inode_of(pages_file_in(workspace.folder())).value_or(0);
  workspace.append({{{"publishing", inode}}});
  job.inode_of_output = inode;
  store.publish(built.t0, built.t0_deaths, job.inputs, job.report);
  job.tell(StageProgress{"writing", 1, 1});
}

KeptIndex kept_index(const Workspace& workspace, const std::string& key) {
  KeptIndex kept;
  for (const nlohmann::json& line : workspace.lines()) {
    if (line.contains(key)) {
      kept.facts = array_facts_in(line[key]);
      kept.is_sound = true;
    } else if (line.contains(kIsForgotten)) {
      kept.is_sound = false;
    }
  }
  return kept;
}

nlohmann::json index_json(const char* kind, const ArrayFileFacts& index) {
  return {{kind, json_of(index)}};
}

void forget_index(Workspace& workspace) { workspace.append({{{kIsForgotten, true}}}); }

void note_index(const Job& job, Workspace& workspace, const char* kind,
                const ArrayFileFacts& index) {
  const KeptIndex before = kept_index(workspace, kind);
  if (before.facts && *before.facts != index) {
    throw Error(
        ErrorCode::corruption,
        "the source reads otherwise than when this build began, and tiles of both would not "
        "fit together",
        job.inputs[0]);
  }
  workspace.sync_names();
  workspace.append({index_json(kind, index)});
}

BuildPlan plan_sorted(const Job& job, const TileTree& tree, SourceDisk disk) {
  disk.is_there = true;
  disk.may_be_less = job.report.resumed;
  BuildPlan plan = plan_build(tree, job.plan_request(disk));
  plan.is_estimate = true;  // as if all tiles were full
  job.tell(plan);
  return plan;
}

}  // namespace ptin::build_internal
