// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build is made from: the one kind of all its inputs, and the options that fit it.
#pragma once

#include <string>
#include <vector>

#include "engine/construct/build_options.h"
#include "engine/construct/read/input_kind.h"

namespace ptin {

/// The kind of source that a build of `inputs` reads. A TIN that is to be repaired counts as
/// points, because only its vertices are wanted.
/// @throws Error invalid_argument  there is no input; rasters and points together; several inputs,
///                                 a TIN among them; a store (.ptin); an option that means nothing
///                                 for the kind of an input, and that would be ignored without a word
/// Cost: opens inputs whose name does not show their kind.
[[nodiscard]] InputKind source_kind(const std::vector<std::string>& inputs,
                                    const BuildOptions& options);

}  // namespace ptin
