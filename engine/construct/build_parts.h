// SPDX-License-Identifier: GPL-3.0-or-later
//
// A build as jobs of a batch system (arrays of Slurm, of AWS Batch, of Kubernetes): the same tasks as
// those of one process, the same bytes. Four phases, each begun when all jobs of the one before are
// done:
//   collapse  `parts` jobs: batches, and the tiles above that lie within the part
//   join      one job: the other tiles above, up to the root
//   tighten   `parts` jobs: batches again, and closing the tiles above that lie within the part
//   publish   one job: closing the others, pages to their places, the index, the output's name
// Jobs are idempotent: a finished job run again does nothing; one that died reports nothing, and is
// run anew. A job that meets damage makes the one that wrote it count as not done. All of them see
// the inputs and the folder beside the output under the same names.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/construct/build.h"

namespace ptin {

enum class PartsPhase : std::uint8_t { kCollapse, kJoin, kTighten };

/// The beginning of a build in parts.
struct BegunParts {
  std::string note;         ///< One line of text that each job is given.
  SourceWarnings warnings;  ///< Those of BuildReport::warnings.
};

/// Reads the source (points and TINs are sorted) and leaves the folder of the build for the jobs.
/// @throws Error as build()
[[nodiscard]] BegunParts begin_parts(const std::vector<std::string>& inputs,
                                     const std::string& output, const BuildOptions& options,
                                     const BuildResources& resources);

/// One job. The join has part 0 alone.
/// @param resources  `memory_bytes`, `threads`, `patience`, `files`, `stop` and `observer` count.
/// @throws Error invalid_argument  a job of the phase before has not reported yet, or there is no
///                                 such part; corruption  a file of another job is damaged: the
///                                 message names the part to be done again; as build()
void do_part(const std::vector<std::string>& inputs, const BuildOptions& options,
             const BuildResources& resources, const std::string& note, PartsPhase phase, int part,
             int parts);

/// The last job.
/// @throws Error as do_part() and build()
BuildReport publish_parts(const std::vector<std::string>& inputs, const std::string& output,
                          const BuildOptions& options, const BuildResources& resources, int parts);

}  // namespace ptin
