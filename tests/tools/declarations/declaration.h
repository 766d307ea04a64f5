// SPDX-License-Identifier: GPL-3.0-or-later
//
// A declaration of a source beside its numbers: a row of the tables in tools/API.md, "What a source
// declares", and files that tell whether the row is true. One list a kind of source.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

struct Declaration {
  /// The first column of the row, as `raster.alpha`: the kind of source, then what is declared.
  std::string key;
  /// Writes a source into the folder, with the declaration and without it, that differs in nothing
  /// else. Returns the arguments of `ptin build` that name it, options included.
  std::function<std::vector<std::string>(const TestFolder& folder, bool is_declared)> write;
};

[[nodiscard]] std::vector<Declaration> raster_declarations();
[[nodiscard]] std::vector<Declaration> raster_format_declarations();
[[nodiscard]] std::vector<Declaration> las_declarations();
[[nodiscard]] std::vector<Declaration> text_declarations();
[[nodiscard]] std::vector<Declaration> layer_declarations();
[[nodiscard]] std::vector<Declaration> hidden_declarations();
[[nodiscard]] std::vector<Declaration> companion_declarations();
[[nodiscard]] std::vector<Declaration> mesh_declarations();
[[nodiscard]] std::vector<Declaration> crs_declarations();    ///< Of all kinds of sources.
[[nodiscard]] std::vector<Declaration> depth_declarations();  ///< Likewise.

}  // namespace ptin::tools::testing
