// SPDX-License-Identifier: GPL-3.0-or-later
//
// An observer made of functions, each of which may be left empty.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/construct/build_observer.h"

namespace ptin::oracle {

class ToldBuild final : public BuildObserver {
 public:
  using Stage = std::function<void(const char* name, std::uint64_t done, std::uint64_t total)>;

  ToldBuild() = default;
  explicit ToldBuild(Stage on_stage_of_build) : on_stage(std::move(on_stage_of_build)) {}

  void plan(const BuildPlan& plan) override {
    if (on_plan) on_plan(plan);
  }
  void progress(const StageProgress& p) override {
    if (on_stage) on_stage(p.stage, p.done, p.total);
  }

  std::function<void(const BuildPlan&)> on_plan;
  Stage on_stage;
};

}  // namespace ptin::oracle
