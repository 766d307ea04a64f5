// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who is told what a build does while it works.
#pragma once

#include "engine/construct/build_plan.h"
#include "engine/construct/hierarchy/stage_progress.h"

namespace ptin {

/// To be derived from; each function does nothing by default. What a function throws ends the
/// build, as a stop does.
/// Threads: called by any thread of the build. plan() and progress() never run at once, with
/// themselves or each other; give_back_memory() may run beside anything.
class BuildObserver {
 public:
  BuildObserver() = default;
  BuildObserver(const BuildObserver&) = delete;
  BuildObserver& operator=(const BuildObserver&) = delete;
  virtual ~BuildObserver() = default;

  /// What the build expects to need, before it begins; over points and TINs once more when they
  /// have been counted.
  virtual void plan(const BuildPlan& plan);
  /// How far it is; often.
  virtual void progress(const StageProgress& progress);
  /// To give freed memory back to the system (malloc_trim): between tiles, where what was freed and
  /// what is wanted next exceed the limit together.
  virtual void give_back_memory();
};

}  // namespace ptin
