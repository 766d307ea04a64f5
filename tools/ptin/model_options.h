// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh as a model to print: closed, at a scale, with heights exaggerated.
#pragma once

#include <optional>
#include <string>

#include "tools/ask/parameter.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

struct ModelOptions {
  std::optional<double> base;  ///< --solid, in the height's unit.
  double reduction = 0;        ///< --scale: how many times smaller it is; 0: none was asked for.
  double exaggeration = 1.0;   ///< A factor on heights.
};

void add_model(ask::Parameters& rows, ModelOptions& options);
/// @throws Error invalid_argument  they mean nothing, or nothing for this format
void check_model(const ModelOptions& options, const std::string& output);
/// Metres of the frame's coordinates become millimetres of the model in an STL, whose programs take
/// them for that, and metres of the model in a GLB; heights are exaggerated.
/// @param metres_per_unit  Of x, y and heights, as Mesh and LocalFrame have them.
void apply_model(const ModelOptions& options, const std::string& output,
                 std::array<double, 3>& metres_per_unit);

}  // namespace ptin::tools
