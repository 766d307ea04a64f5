// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build shows while it works, and what it may take.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/construct/build.h"
#include "tools/progress.h"
#include "tools/progress_fd.h"
#include "tools/ptin/build_command.h"
#include "tools/ptin/command.h"

namespace ptin::tools {

/// a / b, and 0 where b is none.
[[nodiscard]] inline double ratio(double a, double b) { return b > 0 ? a / b : 0.0; }

/// Plan and progress, as the options of Context say.
class BuildShow final : public BuildObserver {
 public:
  BuildShow(const BuildCommand& command, const Context& context);
  void plan(const BuildPlan& plan) override;
  void progress(const StageProgress& progress) override;
  void give_back_memory() override;
  void finish();
  /// The last plan, as --dry-run and --json print it; null before there is one.
  [[nodiscard]] const nlohmann::json& plan_json() const noexcept { return plan_; }

 private:
  [[nodiscard]] std::string detail() const;
  [[nodiscard]] std::string rate() const;
  void end_stage();

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
  nlohmann::json plan_;
};

/// What a build may take, by its options.
/// @throws Error invalid_argument  --memory is no size
[[nodiscard]] BuildResources resources_of(const BuildCommand& command, const Context& context,
                                          BuildObserver& show);

/// BuildResources::patience of processes that work for another one: as long as clients of NFS keep what
/// a folder held, unless it is mounted otherwise.
inline constexpr std::chrono::seconds kPatience{60};

}  // namespace ptin::tools
