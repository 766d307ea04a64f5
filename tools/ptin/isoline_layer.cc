// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/isoline_layer.h"

#include <cmath>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/stop.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

VectorFile::Layer layer_of(const IsolineLayer::Options& options,
                           const ask::Fields<ask::IsolineRow>& fields) {
  using Type = VectorFile::FieldType;
  if (isoline_format_of(options.path) == IsolineFormat::kDxf)
    return {"entities", GeometryKind::kLineZ, {{"Layer", Type::kText}}, {}, "DXF"};
  return {"contour", options.z ? GeometryKind::kLineZ : GeometryKind::kLine,
          ask::layer_fields_of(fields), options.crs};
}

}  // namespace

IsolineFormat isoline_format_of(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".dxf") return IsolineFormat::kDxf;
  if (extension == ".xml") return IsolineFormat::kLandXml;
  if (path != "-" && find_vector_format(path) == nullptr)
    refuse_extension(path, known_isoline_extensions());
  return IsolineFormat::kFields;
}

void check_isoline_fields(const std::string& path, const std::string& what) {
  if (isoline_format_of(path) == IsolineFormat::kFields) return;
  throw Error(ErrorCode::invalid_argument,
              "has no fields, which " + what + " needs; write " + known_vector_extensions(), path);
}

std::string known_isoline_extensions() { return known_vector_extensions() + ", .dxf, .xml"; }

bool IndexLevels::holds(double level) const {
  constexpr double kEvery = 5.0;
  return interval > 0 && std::fmod(std::round((level - base) / interval), kEvery) == 0;
}

IsolineLayer::IsolineLayer(const Options& options)
    : options_(options),
      format_(isoline_format_of(options.path)),
      fields_(ask::isoline_row_fields().told(ask::Told::kProgram & ask::Told::kFeature)) {
  if (!options.steps) fields_ = fields_.without("step").without("splits").without("error");
  if (format_ == IsolineFormat::kLandXml) {
    contours_.emplace(options.path, options.overwrite, options.crs);
  } else {
    VectorFile::Layer layer = layer_of(options, fields_);
    if (format_ == IsolineFormat::kDxf) {
      layer.creation = {header_.emplace(options.crs).option()};
    }
    file_.emplace(options.path, options.overwrite, layer);
  }
}

void IsolineLayer::publish() { contours_ ? contours_->publish() : file_->publish(); }

IsolineLayer::Written IsolineLayer::add(const Isolines& lines, const ask::IsolineStep& step,
                                        const std::optional<Window>& window) {
  Written written;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i % 1024 == 0) {
      stop_if_asked(options_.stop, "writing", options_.path);
    }
    const Isoline line = lines.line(i, points);
    const double elevation = lines.levels()[line.level];
    if (!window) {
      add_line(line.points, line.ring, elevation, step, written);
      continue;
    }
    const ClippedParts clipped = clip_line(line.points, *window);
    for (const std::vector<MapPoint>& part : clipped.parts) {
      add_line(part, line.ring && clipped.whole, elevation, step, written);
    }
  }
  return written;
}

void IsolineLayer::add_line(std::span<const MapPoint> points, bool ring, double elevation,
                            const ask::IsolineStep& step, Written& written) {
  if (format_ == IsolineFormat::kLandXml) {
    contours_->add(points, elevation);
  } else if (format_ == IsolineFormat::kDxf) {
    const VectorFile::Value values[] = {options_.index.holds(elevation) ? "contour_index"
                                                                        : "contour"};
    file_->add(line_geometry(points, &elevation), values);
  } else {
    file_->add(line_geometry(points, options_.z ? &elevation : nullptr),
               ask::layer_values_of(fields_.values_of({next_id_++, elevation, ring, &step})));
  }
  ++written.lines;
  written.rings += ring ? 1 : 0;
  written.points += points.size();
}

}  // namespace ptin::tools
