// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/source_kind.h"

#include <algorithm>
#include <utility>

#include <cpl_vsi.h>

#include "engine/construct/build_option_table.h"
#include "engine/construct/read/tin_file.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// The sets of BuildOption::inputs that an input is in, and what it is called.
std::pair<unsigned, const char*> sets_of(InputKind kind, const std::string& input, bool repairs) {
  switch (kind) {
    case InputKind::kRaster:
      return {BuildOption::kRasters, "this is a raster"};
    case InputKind::kPoints:
      return {BuildOption::kPoints, "these are points"};
    case InputKind::kTin:
      break;
  }
  unsigned sets = BuildOption::kTins;
  if (repairs) {
    sets |= BuildOption::kRepairedTins;
  }
  if (may_have_surfaces(input)) {
    sets |= BuildOption::kSurfaces;
  }
  return {sets, "this is a TIN"};
}

/// Refuses options that mean nothing to an input. One that is not there is reported when it is
/// opened.
void check_fit(const BuildOptions& options, InputKind kind, const std::string& input) {
  const auto [sets, name] = sets_of(kind, input, options.repair);
  for (const BuildOption& option : build_option_table()) {
    VSIStatBufL status;  // of what only GDAL knows too: archives, servers
    if ((option.inputs & sets) == 0 && is_given(option, options) &&
        VSIStatL(input.c_str(), &status) == 0) {
      throw Error(ErrorCode::invalid_argument, misfit_of(option, name), input);
    }
  }
}

}  // namespace

InputKind source_kind(const std::vector<std::string>& inputs, const BuildOptions& options) {
  if (inputs.empty()) {
    throw Error(
        ErrorCode::invalid_argument,
        "no input; name a raster that GDAL reads, or points as LAS, text or a layer that OGR "
        "reads, or a TIN");
  }
  const PointChoice choice = point_choice_of(options);
  std::vector<InputKind> kinds;
  for (const std::string& input : inputs) {
    const InputKind kind = kind_of_input(input, choice);
    check_fit(options, kind, input);
    kinds.push_back(options.repair && kind == InputKind::kTin ? InputKind::kPoints : kind);
  }
  const bool is_one_kind =
      std::count(kinds.begin(), kinds.end(), kinds[0]) == static_cast<std::ptrdiff_t>(kinds.size());
  if (std::find(kinds.begin(), kinds.end(), InputKind::kTin) != kinds.end()) {
    if (inputs.size() != 1) {
      throw Error(ErrorCode::invalid_argument,
                  "several inputs, a TIN among them; build a TIN alone");
    }
  } else if (!is_one_kind) {
    throw Error(ErrorCode::invalid_argument,
                "rasters and points together; build from one kind at a time");
  }
  return kinds[0];
}

}  // namespace ptin
