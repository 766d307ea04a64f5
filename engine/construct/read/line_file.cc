// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/line_file.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/dataset_crs.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/hidden_features.h"
#include "engine/construct/read/tin_file.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {

namespace {

GDALDatasetUniquePtr open_vector(const std::string& path, const GdalSession& session) {
  GDALDatasetUniquePtr data(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (data != nullptr) {
    return data;
  }
  VSIStatBufL status;
  if (VSIStatL(path.c_str(), &status) != 0) {
    throw Error(ErrorCode::not_found, "there is no such file of lines", path);
  }
  throw Error(ErrorCode::invalid_argument, session.explain("this is no vector data that OGR reads"),
              path);
}

/// Takes the lines of one feature after the other.
class LineFeatures {
 public:
  LineFeatures(const std::string& path, const LayerWish& wish, const TakeLine& take)
      : path_(path), wants_areas_(wish.kind == LayerKind::kAreas), take_(take) {}

  void add(const OGRFeature& feature) {
    feature_ = feature.GetFID();
    if (const OGRGeometry* geometry = feature.GetGeometryRef()) {
      add(*geometry);
    }
  }
  [[nodiscard]] std::uint64_t lines() const noexcept { return lines_; }
  [[nodiscard]] bool is_flat() const noexcept { return is_flat_; }

 private:
  [[noreturn]] void refuse_here(const std::string& sentence) const {
    refuse(sentence, path_ + ": feature " + std::to_string(feature_));
  }

  void add(const OGRGeometry& geometry) {
    if (geometry.IsEmpty() != 0) {
      return;
    }
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (type == wkbLineString && !wants_areas_) {
      add_line(*geometry.toLineString());
    } else if (type == wkbPolygon && wants_areas_) {
      for (const OGRLinearRing* ring : *geometry.toPolygon()) {
        add_line(*ring);
      }
    } else if (type == wkbMultiLineString || type == wkbMultiPolygon ||
               type == wkbGeometryCollection) {
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) {
        add(*part);
      }
    } else {
      refuse_here(std::string("this is a ") + geometry.getGeometryName() + ", not a " +
                  (wants_areas_ ? "polygon" : "line") + " with straight sides");
    }
  }

  void add_line(const OGRLineString& line) {
    const bool is_flat = line.Is3D() == 0;
    is_flat_ = is_flat_ || is_flat;
    vertices_.clear();
    for (int i = 0; i < line.getNumPoints(); ++i) {
      vertices_.push_back({number(line.getX(i), "x"), number(line.getY(i), "y"),
                           is_flat ? Decimal{} : number(line.getZ(i), "height")});
    }
    const auto is_same_place = [](const SourcePoint& a, const SourcePoint& b) {
      return a.x == b.x && a.y == b.y;
    };
    if (wants_areas_ && !is_same_place(vertices_.front(), vertices_.back())) {
      vertices_.push_back(vertices_.front());
    }
    ++lines_;
    take_(vertices_, !is_flat);
  }

  [[nodiscard]] Decimal number(double value, const char* role) const {
    if (!(std::abs(value) < 1e15)) {
      refuse_here(std::string("the ") + role + " of a vertex is " +
                  (std::isnan(value) ? "NaN" : "infinite or 10^15 and more") +
                  "; give it a number, or leave the feature out");
    }
    return decimal_of(value);
  }

  const std::string& path_;
  bool wants_areas_;
  const TakeLine& take_;
  std::int64_t feature_ = 0;
  std::uint64_t lines_ = 0;
  bool is_flat_ = false;
  std::vector<SourcePoint> vertices_;
};

}  // namespace

LineFileCrs read_line_file(const std::string& path, const LayerWish& wish, const TakeLine& take,
                           const std::stop_token& stop) {
  if (may_have_surfaces(path)) {
    return read_land_xml_lines(path, wish, take, stop);
  }
  const GdalSession session;
  const ReportedVerticalParts vertical;
  const GDALDatasetUniquePtr data = open_vector(path, session);
  OGRLayer& layer = choose_layer(*data, wish, path);
  LineFileCrs crs;
  crs.crs = declared_crs(*data, layer.GetSpatialRef(), session, path, crs.warnings);
  if (!crs.crs.empty() && !is_crs(crs.crs)) {
    crs.warnings.add(
        {"crs_not_understood",
         "the CRS of these lines, '" + crs.crs.substr(0, 80) +
             "', is not one that GDAL understands; they are taken to be in that of the "
             "points",
         path});
    crs.crs.clear();
  }
  LineFeatures features(path, wish, take);
  session.tell_warnings(path, crs.warnings);
  const HiddenFeatures hidden(*data, layer);
  const GdalSession reading;
  layer.ResetReading();
  for (;;) {
    stop_if_asked(stop, "reading", path);
    const OGRFeatureUniquePtr feature(layer.GetNextFeature());
    if (feature == nullptr) {
      break;
    }
    if (!hidden.holds(*feature)) {
      features.add(*feature);
    }
  }
  if (reading.failed()) {
    throw Error(ErrorCode::io_error, reading.explain("cannot be read on"), path);
  }
  if (features.lines() == 0) {
    refuse(std::string("there is no ") + (wish.kind == LayerKind::kAreas ? "polygon" : "line") +
               " in layer '" + layer.GetName() + "'; leave the file out, or name another layer",
           path);
  }
  crs.is_flat = features.is_flat();
  return crs;
}

}  // namespace ptin
