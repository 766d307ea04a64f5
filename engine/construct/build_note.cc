// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_note.h"

#include "engine/construct/build_job.h"
#include "engine/construct/source_files.h"
#include "engine/construct/tasks/await_file.h"
#include "engine/error.h"

namespace ptin::build_internal {

const BuildNote& require_same_inputs(const BuildNote& note, const std::vector<std::string>& inputs,
                                     const BuildOptions& options) {
  if (input_fingerprint(all_inputs(inputs, options)) != note.inputs) {
    throw Error(ErrorCode::invalid_argument,
                "an input is not the one that the build began with: its size or time of change "
                "differ; build anew, or give all processes the same files",
                inputs.empty() ? "" : inputs.front());
  }
  return note;
}

const BuildNote& require_shared_folders(const BuildNote& note, const BuildResources& resources) {
  for (const std::string& folder : {note.folder, note.temporary}) {
    if (!await_file(folder, resources.patience, resources.stop)) {
      throw Error(ErrorCode::invalid_argument,
                  "this process does not see the folder of the build; it must be one that all "
                  "processes share",
                  folder);
    }
  }
  return note;
}

}  // namespace ptin::build_internal
