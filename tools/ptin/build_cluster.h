// SPDX-License-Identifier: GPL-3.0-or-later
//
// Several processes that do the tasks of one build. The program knows them by this face alone, so that
// what is made without them links none of their libraries.
#pragma once

#include <string>
#include <vector>

#include "engine/construct/build.h"

namespace ptin::tools {

class BuildCluster {
 public:
  BuildCluster() = default;
  BuildCluster(const BuildCluster&) = delete;
  BuildCluster& operator=(const BuildCluster&) = delete;
  virtual ~BuildCluster() = default;

  /// True for the one process that directs the others.
  [[nodiscard]] virtual bool directs() const = 0;
  /// For its build(); null where it has nobody to direct.
  [[nodiscard]] virtual TaskDriver* driver() = 0;
  /// What the others do.  @throws Error as MpiJob::work()
  virtual void work(const std::vector<std::string>& inputs, const BuildOptions& options,
                    const BuildResources& resources) = 0;
};

}  // namespace ptin::tools
