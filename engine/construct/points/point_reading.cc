// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_reading.h"

#include <algorithm>
#include <utility>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/crs_beside.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/points/point_spool.h"
#include "engine/construct/read/column_names.h"
#include "engine/construct/read/input_kind.h"
#include "engine/construct/read/point_stream.h"
#include "engine/construct/read/text_rows.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/external_memory.h"

namespace ptin {
namespace {

/// So many samples are joined at most: all portions together have no more memory than few have.
constexpr std::size_t kMostSamples = std::size_t{1} << 18;

}  // namespace

void EvenSample::add(const SourcePoint& p) {
  if (seen_++ % step_ != 0) {
    return;
  }
  if (points_.size() == kMost) {  // an even number: this point stays one of every 2 k
    for (std::size_t i = 0; i < kMost / 2; ++i) {
      points_[i] = points_[2 * i];
    }
    points_.resize(kMost / 2);
    step_ *= 2;
  }
  points_.push_back({p.x.mantissa, p.y.mantissa, p.x.decimals, p.y.decimals});
}

PortionRead PortionReader::read_to_spool(const PointPortion& portion, std::uint64_t number,
                                         const Task& task) {
  const std::string& path = inputs_[portion.input];
  std::unique_lock alone(one_tin_, std::defer_lock);
  if (point_format_of(path, options_.points) == PointFormat::kTin) {
    alone.lock();
  }
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {  // told in bytes
    const double share = total == 0 ? 0.0 : static_cast<double>(done) / static_cast<double>(total);
    task.tell(static_cast<std::uint64_t>(share * static_cast<double>(portion.bytes)));
  };
  const ExternalMemory memory{files_.files, files_.folder, task.bytes};
  const auto stream = open_point_stream(path, options_.points, options_.nodata,
                                        {&memory, task.stop, progress}, portion.part);
  PortionRead result;
  result.source = stream->facts();
  SourceWarnings of_crs;
  const bool is_layer = point_format_of(path, options_.points) == PointFormat::kLayer;
  // OGR looks at a .prj where one belongs to a layer; that it is another CRS is reported once a
  // file.
  if (result.source.crs.empty() || (!is_layer && portion.part.begin == 0)) {
    take_crs_beside(path, result.source.crs, of_crs);
  }
  SpoolWriter writer(files_.files, files_.path("spool", number));
  EvenSample sample;
  std::vector<SourcePoint> batch;
  while (stream->next(batch)) {
    stop_if_asked(task.stop, "reading", path);
    progress(stream->done(), stream->total());
    for (const SourcePoint& p : batch) {
      if (const auto reason = why_left_out(p, options_)) {
        result.left_out.add(*reason);
        continue;
      }
      result.extent.add(p);
      sample.add(p);
      writer.add(p);
    }
  }
  result.left_out.join(stream->left_out());
  result.classes = stream->classes();
  result.rows = stream->rows();
  result.warnings = stream->warnings();
  result.warnings.join(of_crs);
  result.spool = writer.finish();
  result.samples = sample.points();
  result.sample_step = sample.step();
  return result;
}

std::optional<ArrayFileFacts> PortionReader::read(const PointPortion& portion, std::uint64_t number,
                                                  const Task& task) {
  try {
    const PortionRead result = read_to_spool(portion, number, task);
    ArrayFileWriter file(files_.files, files_.path("read", number));
    file.values(result);
    return file.finish();
  } catch (const QuotesInPart&) {
    without_old(files_.files, files_.path("spool", number));
    return std::nullopt;
  }
}

namespace {

/// Whether the texts of a source are ones of points, as only all parts of each show.
class WholeTexts {
 public:
  explicit WholeTexts(const std::vector<std::string>& inputs) : inputs_(inputs) {}
  /// The lines of this input that were added so far.
  [[nodiscard]] std::uint64_t lines_of(std::size_t input) const noexcept {
    return input == input_ ? all_.lines : 0;
  }
  void add(std::size_t input, const RowsOfPart& part) {
    if (input != input_) {
      check();
      input_ = input;
      all_ = {};
    }
    all_.numbering.join(part.numbering);
    all_.last_row = part.last_row == 0 ? all_.last_row : all_.lines + part.last_row;
    all_.lines += part.lines;
  }
  /// @throws Error invalid_argument  the first column of a text numbers its rows
  void check() const {
    if (const auto fault = fault_of(all_.numbering, point_roles())) {
      refuse(*fault, inputs_[input_] + ":" + std::to_string(all_.last_row));
    }
  }

 private:
  const std::vector<std::string>& inputs_;
  std::size_t input_ = 0;
  RowsOfPart all_;
};

/// Lets lines extend the grid, after all points.
void add_lines(const SourceLines& lines, const SourceOptions& options, const PointReading& reading,
               PointGridScan& scan) {
  for (const LineFileFacts& file : lines.files) {
    // Lines without a CRS are taken to be in that of the points.
    if (options.a_srs.empty() && !file.crs.empty() && !is_same_in_plan(reading.crs, file.crs)) {
      refuse("these lines have another CRS than '" + reading.crs_path +
                 "', or that file has none; transform them first, or say with --a-srs what all of "
                 "them are in",
             file.path);
    }
    if (file.units != DeclaredUnits{} && file.units != reading.units &&
        reading.units != DeclaredUnits{}) {
      refuse("these lines are in other units than the points; bring them to one unit first",
             file.path);
    }
  }
  const std::string crs = is_crs(reading.crs) ? reading.crs : "";
  const bool degrees = resolve_crs(crs, options.a_srs, "").geographic;
  for (const LineSet* set : {&lines.breaklines, &lines.flat_breaklines, &lines.rings}) {
    const bool is_flat =
        set == &lines.flat_breaklines || (set == &lines.rings && lines.rings_are_flat);
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

/// A clause for who chose among classes.
std::string classes_that_are_there(const PointClasses& classes) {
  return classes.are_known() ? "; there are points of the classes " + classes.names() : "";
}

/// Every step-th of the samples of a portion; their weight grows by as much.
void add_samples(const PortionRead& read, std::size_t step, PointReading& reading) {
  for (std::size_t i = 0; i < read.samples.size(); i += step) {
    reading.samples.push_back({read.samples[i], read.sample_step * step});
  }
}

}  // namespace

PointReading join_portions(const std::vector<std::string>& inputs, const SourceOptions& options,
                           const PointFiles& files, const std::vector<SpooledPortion>& portions) {
  const std::string context = inputs.empty() ? "" : inputs[0];
  PointReading reading{.scan = PointGridScan(options.resolution, context)};
  SourceAgreement agreement(options);
  WholeTexts texts(inputs);
  std::vector<std::uint64_t> points_of(inputs.size());
  std::vector<bool> agrees(inputs.size(), false);
  const std::size_t sample_step = portions.size() * EvenSample::kMost / kMostSamples + 1;
  for (std::size_t i = 0; i < portions.size(); ++i) {
    const SpooledPortion& p = portions[i];
    ArrayFileReader file = files.open(files.path("read", p.number), p.facts);
    PortionRead read;
    file.values(read);
    if (i == 0 || portions[i - 1].portion.input != p.portion.input) {
      reading.scan.add_source(read.source);
    }
    const std::uint64_t lines_before = texts.lines_of(p.portion.input);
    if (read.rows) {
      texts.add(p.portion.input, *read.rows);
    }
    points_of[p.portion.input] += read.extent.points + read.left_out.total();
    if (!agrees[p.portion.input] && (points_of[p.portion.input] > 0 || declares_crs(read.source))) {
      agreement.add(read.source, inputs[p.portion.input]);
      agrees[p.portion.input] = true;
    }
    read.extent.far.set_input(p.portion.input);
    reading.scan.add(read.extent);
    reading.left_out.join(read.left_out);
    reading.classes.join(read.classes);
    reading.warnings.join(warnings_that_count(read.warnings, options, lines_before));
    if (read.extent.points > 0) {
      reading.spools.push_back({p.number, read.extent.points, read.spool});
    }
    add_samples(read, sample_step, reading);
  }
  texts.check();
  if (reading.scan.points() == 0) {
    refuse(reading.left_out.total() == 0
               ? "there is no point in this file"
               : "every point is left out: none lies in the bounds, with a height and of a chosen "
                 "class" +
                     classes_that_are_there(reading.classes),
           context);
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (points_of[i] == 0) {
      reading.empty_inputs.push_back(i);
    }
  }
  reading.crs = agreement.crs();
  reading.vertical_crs = options.vertical_crs.empty() ? agreement.vertical_crs() : "";
  reading.units = agreement.units();
  reading.crs_path = agreement.path();
  return reading;
}

PointGrid grid_with_lines(const PointReading& reading, const SourceOptions& options) {
  PointGridScan scan = reading.scan;
  if (options.lines != nullptr && !options.lines->is_empty()) {
    add_lines(*options.lines, options, reading, scan);
  }
  return scan.grid();
}

}  // namespace ptin
