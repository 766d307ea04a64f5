// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines as a vector layer, by gdal_contour's conventions: layer `contour`, fields ID and elev; as
// DXF; as LandXML.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/ask/questions.h"
#include "tools/formats/dxf_units.h"
#include "tools/formats/land_xml_contours.h"
#include "tools/formats/vector_file.h"

namespace ptin::tools {

/// Where isolines can go. A DXF has no fields: lines lie at their heights, on the layers `contour` and
/// `contour_index`. LandXML has the height of each.
enum class IsolineFormat { kFields, kDxf, kLandXml };
/// @param path  "-" is GeoJSON on stdout.
/// @throws Error invalid_argument  unknown extension
[[nodiscard]] IsolineFormat isoline_format_of(const std::string& path);
/// The same of what needs fields.
/// @param what  What wants them, for the error.
/// @throws Error invalid_argument  also: the format has none
void check_isoline_fields(const std::string& path, const std::string& what);
/// The extensions as "`.gpkg`, ..." for help texts.
[[nodiscard]] std::string known_isoline_extensions();

/// Which levels are index contours, drawn heavier on paper: every fifth multiple of the interval,
/// counted from the base. None where levels were given one by one.
struct IndexLevels {
  double interval = 0.0;  ///< 0: none.
  double base = 0.0;
  [[nodiscard]] bool holds(double level) const;
};

class IsolineLayer {
 public:
  struct Options {
    std::string path;
    bool overwrite = false;
    bool z = false;      ///< Points carry the height of their line.
    bool steps = false;  ///< Lines of several states; adds the fields of ask::IsolineStep.
    CrsFacts crs;
    IndexLevels index;
    std::stop_token stop;
  };
  struct Written {
    std::uint64_t lines = 0, rings = 0, points = 0;
  };

  /// @throws Error as VectorFile, LandXmlContours
  explicit IsolineLayer(const Options& options);

  /// Writes lines behind those that were written before, cut at `window` when there is one.
  /// @throws Error cancelled, io_error
  Written add(const Isolines& lines, const ask::IsolineStep& step = {},
              const std::optional<Window>& window = {});
  /// @throws Error as VectorFile::publish
  void publish();

 private:
  void add_line(std::span<const MapPoint> points, bool ring, double elevation,
                const ask::IsolineStep& step, Written& written);

  Options options_;
  IsolineFormat format_;
  std::optional<DxfHeader> header_;          ///< A drawing's, which needs it until it is closed.
  std::optional<VectorFile> file_;           ///< The file of any format but LandXML,
  std::optional<LandXmlContours> contours_;  ///< whose contours are here.
  ask::Fields<ask::IsolineRow> fields_;      ///< Those that the layer has.
  std::uint64_t next_id_ = 0;
};

}  // namespace ptin::tools
