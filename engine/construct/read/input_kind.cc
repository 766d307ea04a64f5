// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/input_kind.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/ogr_points.h"
#include "engine/construct/read/tin_file.h"
#include "engine/error.h"
#include "storage/layout.h"

namespace ptin {
namespace {

constexpr std::string_view kPacked = ".gz";

std::string lower_case(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

bool is_las(const std::string& path) {
  const std::string name = lower_case(path);
  return name.ends_with(".las") || name.ends_with(".laz");
}

bool is_text(const std::string& path) {
  std::string name = lower_case(path);
  if (is_packed(path)) {
    name.resize(name.size() - kPacked.size());
  }
  return name.ends_with(".csv") || name.ends_with(".xyz") || name.ends_with(".txt") ||
         name.ends_with(".tsv");
}

/// Refuses a store, which GDAL opens as a raster where the driver of tools/gdal is installed: a build
/// of what was simplified would certify its errors against that, and not against the ground.
void refuse_store(const std::string& path) {
  const GdalSession session;
  const std::string first = beginning_of_file(path, layout::kMagic.size()).value_or("");
  if (std::equal(first.begin(), first.end(), layout::kMagic.begin(), layout::kMagic.end(),
                 [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; })) {
    refuse(
        "this is a store, not a source; build from its own source, or from what `ptin export` "
        "writes of it",
        path);
  }
}

}  // namespace

bool wants_layer(const PointChoice& choice) noexcept {
  return !choice.layer.empty() || !choice.z_field.empty();
}

bool is_packed(const std::string& path) { return lower_case(path).ends_with(kPacked); }

std::optional<InputKind> kind_by_name(const std::string& path) {
  if (is_tin_file(path)) {
    return InputKind::kTin;
  }
  if (is_las(path) || is_text(path)) {
    return InputKind::kPoints;
  }
  return std::nullopt;
}

InputKind kind_of_input(const std::string& path, const PointChoice& choice) {
  if (const std::optional<InputKind> kind = kind_by_name(path)) {
    return *kind;
  }
  refuse_store(path);
  return wants_layer(choice) || OgrPoints::reads(path) ? InputKind::kPoints : InputKind::kRaster;
}

PointFormat point_format_of(const std::string& path, const PointChoice& choice) {
  if (is_tin_file(path)) {
    return PointFormat::kTin;
  }
  if (is_las(path)) {
    return PointFormat::kLas;
  }
  return is_text(path) && !wants_layer(choice) ? PointFormat::kText : PointFormat::kLayer;
}

}  // namespace ptin
