// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/source_kind.h"

#include <algorithm>

#include <cpl_vsi.h>

#include "engine/construct/read/tin_file.h"
#include "engine/error.h"

namespace ptin {

namespace {

const char* misfit_of_raster(const BuildOptions& o) {
  if (o.resolution)
    return "--resolution is for points and TINs, and this is a raster; leave it out";
  if (!o.classes.empty()) return "--class is for LAS, and this is a raster; leave it out";
  if (!o.columns.empty())
    return "--columns is for points as text, and this is a raster; leave it out";
  if (o.skip_invalid)
    return "--skip-invalid is for points as text, and this is a raster; leave it out";
  if (o.returns != ReturnChoice::kAll)
    return "--returns is for LAS, and this is a raster; leave it out";
  if (o.duplicates) return "--duplicates is for points, and this is a raster; leave it out";
  if (o.repair) return "--repair is for TINs, and this is a raster; leave it out";
  if (o.max_edge) return "--max-edge is for points, and this is a raster; leave it out";
  if (!o.breaklines.empty())
    return "--breaklines is for points, and this is a raster; leave it out";
  if (!o.boundary.empty()) return "--boundary is for points, and this is a raster; leave it out";
  return nullptr;
}

const char* misfit_of_points(const BuildOptions& o) {
  return o.repair ? "--repair is for TINs, and these are points; leave it out" : nullptr;
}

const char* misfit_of_tin(const BuildOptions& o, const std::string& input) {
  if (!o.classes.empty()) return "--class is for LAS, and this is a TIN; leave it out";
  if (!o.columns.empty()) return "--columns is for points as text, and this is a TIN; leave it out";
  if (o.skip_invalid)
    return "--skip-invalid is for points as text, and this is a TIN; leave it out";
  if (o.returns != ReturnChoice::kAll)
    return "--returns is for LAS, and this is a TIN; leave it out";
  if (o.duplicates && !o.repair)
    return "--duplicates is for points, and for TINs with --repair, and this is a TIN; leave it "
           "out";
  if (!o.z_field.empty()) return "--z-field is for points, and this is a TIN; leave it out";
  if (!o.layer.empty() && !may_have_surfaces(input))
    return "--layer is for points and for the surfaces of LandXML, and this is another TIN; leave "
           "it out";
  if (o.bbox && !o.repair)
    return "a TIN is not cut by --bbox; build it whole, then refine or export a window";
  if (o.max_edge && !o.repair)
    return "--max-edge is for points, and for TINs with --repair, and this is a TIN; leave it out";
  if (!o.breaklines.empty() && !o.repair)
    return "--breaklines is for points, and for TINs with --repair, and this is a TIN; leave it "
           "out";
  if (!o.boundary.empty() && !o.repair)
    return "--boundary is for points, and for TINs with --repair, and this is a TIN; leave it out";
  return nullptr;
}

/// Why an option that was given means nothing to an input of this kind; null when all do.
const char* misfit_of(const BuildOptions& options, InputKind kind, const std::string& input) {
  switch (kind) {
    case InputKind::kRaster:
      return misfit_of_raster(options);
    case InputKind::kPoints:
      return misfit_of_points(options);
    case InputKind::kTin:
      break;
  }
  return misfit_of_tin(options, input);
}

/// An input that is not there is told of when it is opened.
void check_fit(const BuildOptions& options, InputKind kind, const std::string& input) {
  const char* misfit = misfit_of(options, kind, input);
  VSIStatBufL status;  // of what only GDAL knows too: archives, servers
  if (misfit != nullptr && VSIStatL(input.c_str(), &status) == 0) {
    throw Error(ErrorCode::invalid_argument, misfit, input);
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
