// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines as a vector layer, by gdal_contour's conventions: layer `contour`, fields ID and elev.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/query/terrain.h"
#include "tools/formats/vector_file.h"

namespace ptin::tools {

/// A state of isolines that change while splits arrive; written as the fields `step`, `splits` and
/// `error`.
struct IsolineStep {
  std::uint64_t step = 0;        ///< From 0.
  std::uint64_t splits = 0;      ///< Applied to T0 by then.
  double certified_error = 0.0;  ///< Of the TIN whose isolines these are.
};

class IsolineLayer {
 public:
  struct Options {
    std::string path;
    bool overwrite = false;
    bool z = false;      ///< Points carry the height of their line.
    bool steps = false;  ///< Lines of several states; adds the fields of IsolineStep.
    std::string crs_wkt;
    std::stop_token stop;
  };
  struct Written {
    std::uint64_t lines = 0, rings = 0, points = 0;
  };

  /// @throws Error as VectorFile
  explicit IsolineLayer(const Options& options);

  /// Writes lines behind those that were written before, cut at `window` when there is one.
  /// @throws Error cancelled, io_error
  Written add(const Isolines& lines, const IsolineStep& step = {},
              const std::optional<Window>& window = {});
  /// @throws Error as VectorFile::publish
  void publish() { file_.publish(); }

 private:
  void add_line(std::span<const MapPoint> points, bool ring, double elevation,
                const IsolineStep& step, Written& written);

  Options options_;
  VectorFile file_;
  std::uint64_t next_id_ = 0;
};

}  // namespace ptin::tools
