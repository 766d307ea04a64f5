// SPDX-License-Identifier: GPL-3.0-or-later
//
// The observer of a build: it hears what the build does while it works.
#pragma once

#include "engine/construct/build_plan.h"
#include "engine/construct/tasks/stage_progress.h"

namespace ptin {

/// To be derived from; each function does nothing by default. A function that throws ends the build
/// with the error that it throws; one that is no Error is reported as `internal`.
/// Threads: called by any thread of the build. plan() and progress() never run at once, with
/// themselves or each other, so a slow one delays the workers; give_back_memory() may run beside
/// anything.
class BuildObserver {
 public:
  BuildObserver() = default;
  BuildObserver(const BuildObserver&) = delete;
  BuildObserver& operator=(const BuildObserver&) = delete;
  virtual ~BuildObserver() = default;

  /// What the build expects to need: before it begins, and over points and TINs once more when they
  /// have been sorted. A pipe has only the latter, since it cannot be counted before it is read.
  virtual void plan(const BuildPlan& /*plan*/) {}
  /// How far it is; often.
  virtual void progress(const StageProgress& /*progress*/) {}
  /// To give freed memory back to the system (malloc_trim): between tiles, where what was freed and
  /// what is wanted next exceed the limit together.
  virtual void give_back_memory() {}
};

}  // namespace ptin
