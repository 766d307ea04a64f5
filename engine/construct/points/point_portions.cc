// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_portions.h"

#include <algorithm>
#include <filesystem>

#include <cpl_vsi.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/read/input_kind.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// How much of the file is one portion, in the unit of PointStream::total(); 0: all of it.
std::uint64_t size_of_portion(const std::string& path, PointFormat format,
                              const PointStream& stream, const PortionSizes& sizes) {
  if (format == PointFormat::kLas) {
    return stream.is_compressed() ? sizes.laz_records : sizes.las_records;
  }
  // From the middle of an archive or of a packed file nobody reads without reading what is before.
  const bool is_file = !path.starts_with("/vsi") || path.starts_with("/vsimem/");
  return format == PointFormat::kText && is_file && !is_packed(path) ? sizes.text_bytes : 0;
}

/// Adds the portions of a file, no more than it has parts: a header may lie about its points, and a
/// portion of each 2^18 of 2^60 would take all memory.
void cut(const PointPortion& whole, const PointStream& stream, std::uint64_t size,
         std::vector<PointPortion>& portions) {
  const std::uint64_t total = stream.total();
  const std::uint64_t parts =
      size == 0 ? 1 : std::min(total / size + (total % size != 0), stream.most_parts());
  if (parts <= 1) {
    portions.push_back(whole);
    return;
  }
  const std::uint64_t step = total / parts + (total % parts != 0);
  for (std::uint64_t i = 0; i < parts; ++i) {
    PointPortion portion = whole;
    portion.part.begin = i * step;
    portion.part.end = i + 1 == parts ? portion.part.end : (i + 1) * step;
    portion.bytes = std::max<std::uint64_t>(whole.bytes / parts, 1);
    portions.push_back(portion);
  }
}

/// "no unit of x and y and heights in 'US survey foot'".
std::string named(const DeclaredUnits& units) {
  return (units.plane.empty() ? "no unit of x and y" : "x and y in '" + units.plane + "'") +
         (units.heights.empty() ? " and none of heights"
                                : " and heights in '" + units.heights + "'");
}

}  // namespace

bool can_be_read_once_only(const std::string& path) {
  std::error_code ignored;
  const auto type = std::filesystem::status(path, ignored).type();
  return type == std::filesystem::file_type::fifo ||
         type == std::filesystem::file_type::character ||
         type == std::filesystem::file_type::socket;
}

void SourceAgreement::add(const PointStreamFacts& facts, const std::string& path) {
  const bool counts = options_->a_srs.empty();
  if (!has_first_) {
    has_first_ = true;
    path_ = path;
    crs_ = counts ? facts.crs : "";
    vertical_crs_ = counts ? facts.vertical_crs : "";
    units_ = facts.units;
    return;
  }
  if (counts) {
    const auto crs = difference_of({crs_, vertical_crs_}, {facts.crs, facts.vertical_crs});
    if (crs) {
      refuse("this file declares " + crs->second + ", and '" + path_ + "' declares " + crs->first +
                 "; transform it first, or say with --a-srs what all of them are in",
             path);
    }
  }
  if (units_ != facts.units) {
    refuse("this file declares " + named(facts.units) + ", and '" + path_ + "' declares " +
               named(units_) + "; bring them to one unit first",
           path);
  }
}

PointPortion whole_portion(const std::vector<std::string>& inputs, std::size_t input) {
  const GdalSession session;
  VSIStatBufL status;
  const bool is_known = !can_be_read_once_only(inputs[input]) &&
                        VSIStatL(inputs[input].c_str(), &status) == 0 && status.st_size > 0;
  return {input, {}, is_known ? static_cast<std::uint64_t>(status.st_size) : 1};
}

std::vector<PointPortion> cut_into_portions(const std::vector<std::string>& inputs,
                                            const SourceOptions& options,
                                            const PortionSizes& sizes) {
  std::vector<PointPortion> portions;
  SourceAgreement agreement(options);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string& path = inputs[i];
    const PointPortion whole = whole_portion(inputs, i);
    if (can_be_read_once_only(path)) {
      portions.push_back(whole);
      continue;
    }
    const PointFormat format = point_format_of(path, options.points);
    if (format == PointFormat::kTin) {  // it is sorted when it is opened
      portions.push_back(whole);
      continue;
    }
    const auto stream = open_point_stream(path, options.points, options.nodata);
    if (stream->total() > 0 || declares_crs(stream->facts())) {
      agreement.add(stream->facts(), path);
    }
    cut(whole, *stream, size_of_portion(path, format, *stream, sizes), portions);
  }
  return portions;
}

}  // namespace ptin
