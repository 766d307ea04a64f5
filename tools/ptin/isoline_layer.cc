// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/isoline_layer.h"

#include "engine/error.h"
#include "engine/query/terrain.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

VectorFile::Layer layer_of(const IsolineLayer::Options& options) {
  using Type = VectorFile::FieldType;
  VectorFile::Layer layer{"contour",
                          options.z ? wkbLineString25D : wkbLineString,
                          {{"ID", Type::kInteger}, {"elev", Type::kReal}},
                          options.crs_wkt};
  if (options.steps) {
    layer.fields.push_back({"step", Type::kInteger});
    layer.fields.push_back({"splits", Type::kReal});  // may exceed 32 bits
    layer.fields.push_back({"error", Type::kReal});
  }
  return layer;
}

}  // namespace

IsolineLayer::IsolineLayer(const Options& options)
    : options_(options), file_(options.path, options.overwrite, layer_of(options)) {}

IsolineLayer::Written IsolineLayer::add(const Isolines& lines, const IsolineStep& step,
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
                            const IsolineStep& step, Written& written) {
  const VectorFile::Value values[] = {static_cast<std::int64_t>(next_id_++), elevation,
                                      static_cast<std::int64_t>(step.step),
                                      static_cast<double>(step.splits), step.certified_error};
  file_.add(line_geometry(points, options_.z ? &elevation : nullptr),
            std::span(values).first(options_.steps ? 5 : 2));
  ++written.lines;
  written.rings += ring ? 1 : 0;
  written.points += points.size();
}

}  // namespace ptin::tools
