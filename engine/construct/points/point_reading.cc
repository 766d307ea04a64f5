// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_reading.h"

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/read/point_stream.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {
namespace {

/// The CRS that all files share.
class CommonCrs {
 public:
  void add(const std::string& crs, const std::string& path) {
    if (first_ && !is_same_crs(crs_, crs)) {
      refuse("this file has another CRS than '" + path_ + "', or one of them has none; transform " +
                 "it first, or say with --a-srs what all of them are in",
             path);
    }
    if (!first_) {
      first_ = true;
      crs_ = crs;
      path_ = path;
    }
  }
  [[nodiscard]] const std::string& text() const { return crs_; }
  /// Lines without a CRS are taken to be in that of the points.
  void check_lines(const std::string& crs, const std::string& path) const {
    if (!crs.empty() && !is_same_in_plan(crs_, crs)) {
      refuse("these lines have another CRS than '" + path_ +
                 "', or that file has none; transform them first, or say with --a-srs what all of "
                 "them are in",
             path);
    }
  }

 private:
  bool first_ = false;
  std::string crs_, path_;
};

/// Lets lines extend the grid, after all points.
void add_lines(const SourceLines& lines, const SourceOptions& options, const CommonCrs& crs,
               PointGridScan& scan, const PointReading& reading) {
  for (const LineFileFacts& file : lines.files) {
    if (options.a_srs.empty()) {
      crs.check_lines(file.crs, file.path);
    }
    if (file.units != DeclaredUnits{} && file.units != reading.units &&
        reading.units != DeclaredUnits{}) {
      refuse("these lines are in other units than the points; bring them to one unit first",
             file.path);
    }
  }
  const bool degrees = resolve_crs(crs.text(), options.a_srs, "").geographic;
  for (const LineSet* set : {&lines.breaklines, &lines.rings}) {
    const bool is_flat = set == &lines.rings && lines.rings_are_flat;
    for (std::size_t i = 0; i < set->vertices.size(); ++i) {
      const SourcePoint& v = set->vertices[i];
      const bool has_height = !is_flat && (set->has_ground.empty() || set->has_ground[i] != 0);
      if (has_height && options.nodata && to_double(v.z) == *options.nodata) {
        refuse(
            "a vertex of a breakline or of the boundary has the height that means none; give it "
            "its own, or leave the line out",
            lines.files.front().path);
      }
      scan.add_line_vertex(v, has_height, degrees);
    }
  }
  if (scan.lines_are_elsewhere()) {
    refuse(
        "no breakline and no side of the boundary lies where the points do; the lines are in "
        "another CRS, or belong to another terrain",
        lines.files.front().path);
  }
}

}  // namespace

PointReading read_sources(const std::vector<std::string>& paths, const SourceOptions& options,
                          const std::function<void(const SourcePoint&)>& take,
                          const std::stop_token& stop,
                          const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                          const ExternalMemory* memory) {
  PointReading reading;
  PointGridScan scan(options.resolution, paths.empty() ? "" : paths[0]);
  CommonCrs crs, vertical_crs;
  std::vector<SourcePoint> batch;
  std::uint64_t count = 0;
  for (const std::string& path : paths) {
    const auto stream =
        open_point_stream(path, options.points, options.nodata, {memory, stop, progress});
    if (options.a_srs.empty()) {
      crs.add(stream->facts().crs, path);
      vertical_crs.add(stream->facts().vertical_crs, path);
    }
    scan.add_source(stream->facts());
    if (path == paths.front()) {
      reading.units = stream->facts().units;
    } else if (reading.units != stream->facts().units) {
      refuse("this file has other units than '" + paths.front() +
                 "', or one of them names none; bring them to one unit first",
             path);
    }
    while (stream->next(batch)) {
      stop_if_asked(stop, "reading", path);
      if (progress) {
        progress(stream->done(), stream->total());
      }
      count += batch.size();
      for (const SourcePoint& p : batch) {
        if (is_wanted(p, options)) {
          scan.add(p);
          take(p);
        }
      }
    }
    reading.left_out += stream->left_out();
    reading.largest_shift = std::max(reading.largest_shift, stream->largest_shift());
  }
  if (scan.points() == 0) {
    refuse(count + reading.left_out == 0
               ? "there is no point in this file"
               : "every point is left out: none lies in the bounds, with a height and of a chosen "
                 "class",
           paths.empty() ? "" : paths[0]);
  }
  reading.left_out += count - scan.points();
  reading.points = scan.points();
  if (options.lines != nullptr && !options.lines->is_empty()) {
    add_lines(*options.lines, options, crs, scan, reading);
  }
  reading.grid = scan.grid();
  reading.crs = crs.text();
  reading.vertical_crs = options.vertical_crs.empty() ? vertical_crs.text() : "";
  return reading;
}

}  // namespace ptin
