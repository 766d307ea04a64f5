// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/open_points.h"

#include <algorithm>

#include <cpl_vsi.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/input_kind.h"
#include "engine/construct/read/las_reader.h"
#include "engine/construct/read/ogr_points.h"
#include "engine/construct/read/xyz_reader.h"
#include "engine/construct/tin/tin_vertices.h"
#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::size_t kBatchPoints = 4096;

/// Text, in batches.
class TextPoints final : public PointStream {
 public:
  /// @param nodata  Takes the place of the value that comments say means no height.
  /// @param invalid_row  As StreamResources::invalid_row.
  TextPoints(const std::string& path, const PointChoice& choice, std::optional<double> nodata,
             TakeInvalidRow invalid_row, const PointPart& part)
      : path_(path),
        is_whole_(part.is_whole()),
        invalid_row_(std::move(invalid_row)),
        reader_(path, choice.columns, part,
                choice.skip_invalid || invalid_row_
                    ? [this](std::uint64_t line, const std::string& fault) { skip(line, fault); }
                    : TakeInvalidRow()) {
    const GdalSession session;
    VSIStatBufL status;
    if (!is_packed(path) && VSIStatL(path.c_str(), &status) == 0) {
      total_ = std::min(part.end, static_cast<std::uint64_t>(status.st_size));
      total_ -= std::min(part.begin, total_);
    }
    facts_.units = reader_.units();
    if (facts_.units.plane == "degree") {
      facts_.units.plane.clear();  // Only a CRS says what degrees are on the ground.
    }
    take_comments(nodata.has_value());
    reader_.declared().tell(path, warnings_);
    note_unknown_units(path);
  }
  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override {
    batch.clear();
    SourcePoint point;
    while (batch.size() < kBatchPoints && reader_.next(point)) {
      if (nodata_ && to_double(point.z) == *nodata_) {
        ++left_out_;
      } else {
        batch.push_back(point);
      }
    }
    return !batch.empty();
  }
  [[nodiscard]] LeftOutPoints left_out() const noexcept override {
    LeftOutPoints points;
    points.add(LeftOutReason::kNodata, left_out_);
    points.add(LeftOutReason::kInvalid, skipped_.count);
    return points;
  }
  [[nodiscard]] SourceWarnings warnings() const override {
    SourceWarnings all = warnings_;
    if (skipped_.count > 0) {
      all.add(skipped_);
    }
    return all;
  }
  [[nodiscard]] std::optional<RowsOfPart> rows() const override {
    return is_whole_ ? std::nullopt : std::optional(reader_.rows());
  }
  [[nodiscard]] std::uint64_t done() const noexcept override { return reader_.bytes_read(); }
  [[nodiscard]] std::uint64_t total() const noexcept override { return total_; }

 private:
  /// Counts a row that is no point; the first of them is reported.
  void skip(std::uint64_t line, const std::string& fault) {
    if (skipped_.count++ == 0) {
      skipped_.kind = "invalid_rows";
      skipped_.message = "a row is no point and was passed over: " + fault;
      skipped_.file = path_;
      skipped_.line = line;
    }
    if (invalid_row_) {
      invalid_row_(line, fault);
    }
  }
  /// Takes what comments declare; the names of columns go before them.
  void take_comments(bool is_nodata_told) {
    const DeclaredComments& declared = reader_.declared();
    facts_.crs = declared.crs();
    facts_.vertical_crs = declared.vertical_crs();
    const DeclaredUnits units = declared.units();
    facts_.units.plane = facts_.units.plane.empty() ? units.plane : facts_.units.plane;
    facts_.units.heights = facts_.units.heights.empty() ? units.heights : facts_.units.heights;
    nodata_ = is_nodata_told ? std::nullopt : declared.nodata();
  }
  /// Warns of what names of columns say in brackets and nobody understands.
  void note_unknown_units(const std::string& path) {
    const std::string remark = reader_.unknown_unit();
    if (!remark.empty()) {
      warnings_.add({.kind = "unknown_unit",
                     .message = "the name of a coordinate's column says '" + remark +
                                "', which is no unit that is known and not used; say with --a-srs "
                                "and --vertical-crs what the coordinates are",
                     .file = path});
    }
  }

  std::string path_;
  bool is_whole_;
  TakeInvalidRow invalid_row_;
  XyzReader reader_;
  SourceWarning skipped_;  ///< What to say of the rows that were passed over.
  PointStreamFacts facts_;
  SourceWarnings warnings_;
  std::optional<double> nodata_;  ///< The one that comments declare.
  std::uint64_t total_ = 0, left_out_ = 0;
};

/// @throws Error invalid_argument  a choice means nothing for the format of the file
void check_choice(const std::string& path, const PointChoice& choice, PointFormat format) {
  if (!choice.classes.empty() && (wants_layer(choice) || format != PointFormat::kLas)) {
    throw Error(ErrorCode::invalid_argument,
                "only LAS has classes; leave the choice of classes out, or build LAS files alone",
                path);
  }
  if (!choice.columns.empty() && format != PointFormat::kText) {
    throw Error(ErrorCode::invalid_argument,
                "--columns is for points as text, not for LAS and layers; leave it out", path);
  }
  if (choice.skip_invalid && format != PointFormat::kText) {
    throw Error(ErrorCode::invalid_argument,
                "--skip-invalid is for points as text, not for LAS and layers; leave it out", path);
  }
  if (choice.returns != ReturnChoice::kAll &&
      (wants_layer(choice) || format != PointFormat::kLas)) {
    throw Error(ErrorCode::invalid_argument,
                "only LAS has returns; leave the choice of returns out, or build LAS files alone",
                path);
  }
  if (format == PointFormat::kLas && wants_layer(choice)) {
    throw Error(ErrorCode::invalid_argument,
                "LAS has no layers and attributes; leave --layer and --z-field out", path);
  }
}

}  // namespace

std::unique_ptr<PointStream> open_point_stream(const std::string& path, const PointChoice& choice,
                                               std::optional<double> nodata,
                                               const StreamResources& resources,
                                               const PointPart& part) {
  const PointFormat format = point_format_of(path, choice);
  check_choice(path, choice, format);
  switch (format) {
    case PointFormat::kTin:
      return std::make_unique<TinVertices>(path, choice, nodata, resources);
    case PointFormat::kLas:
      return std::make_unique<LasReader>(path, choice, part);
    case PointFormat::kText:
      return std::make_unique<TextPoints>(path, choice, nodata, resources.invalid_row, part);
    case PointFormat::kLayer:
      break;
  }
  return std::make_unique<OgrPoints>(path, choice);
}

}  // namespace ptin
