// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers in the formats of OGR.
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"
#include "tools/formats/layer_writer.h"
#include "tools/output/companion_files.h"
#include "tools/output/file_name.h"
#include "tools/output/gdal_output.h"
#include "tools/output/output_file.h"
#include "tools/refused_memory.h"

namespace ptin::tools {

namespace {

namespace fs = std::filesystem;

/// Switches off what SQLite does for the safety of a file, as long as the object lives. Nobody
/// knows of the file yet, and nobody keeps a part of it: the finished file is synced before it gets
/// its name.
class UnsafeSqlite {
 public:
  UnsafeSqlite() {
    CPLSetThreadLocalConfigOption("OGR_SQLITE_SYNCHRONOUS", "OFF");
    CPLSetThreadLocalConfigOption("OGR_SQLITE_JOURNAL", "OFF");
  }
  UnsafeSqlite(const UnsafeSqlite&) = delete;
  UnsafeSqlite& operator=(const UnsafeSqlite&) = delete;
  ~UnsafeSqlite() {
    CPLSetThreadLocalConfigOption("OGR_SQLITE_SYNCHRONOUS", nullptr);
    CPLSetThreadLocalConfigOption("OGR_SQLITE_JOURNAL", nullptr);
  }
};

std::unique_ptr<OGRSpatialReference> reference_of(const std::string& wkt) {
  auto reference = std::make_unique<OGRSpatialReference>();
  reference->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (wkt.empty() || reference->importFromWkt(wkt.c_str()) != OGRERR_NONE) return nullptr;
  return reference;
}

OGRFieldType ogr_type(VectorFile::FieldType type) {
  if (type == VectorFile::FieldType::kReal) return OFTReal;
  if (type == VectorFile::FieldType::kText) return OFTString;
  return type == VectorFile::FieldType::kInteger ? OFTInteger64 : OFTInteger;
}

void set_field(OGRFeature& feature, int field, const VectorFile::Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    feature.SetField(field, static_cast<GIntBig>(*integer));
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    feature.SetField(field, text->c_str());
  } else if (const double number = std::get<double>(value); std::isfinite(number)) {
    feature.SetField(field, number);
  } else {
    feature.SetFieldNull(field);
  }
}

void create_fields(OGRLayer& layer, const VectorFile::Layer& wanted, const std::string& path) {
  for (const VectorFile::Field& f : wanted.fields) {
    OGRFieldDefn field(f.name.c_str(), ogr_type(f.type));
    if (f.type == VectorFile::FieldType::kInteger) field.SetWidth(18);
    if (f.type == VectorFile::FieldType::kFlag) field.SetWidth(1);
    if (f.type == VectorFile::FieldType::kBoolean) field.SetSubType(OFSTBoolean);
    if (layer.CreateField(&field) != OGRERR_NONE) {
      throw gdal_failure(std::string("cannot create the field ") + f.name, path);
    }
  }
}

/// How a whole file of a format ends, but for white space, where GDAL's driver does not report when
/// the disk is full; else empty.
std::string_view end_of_whole_file(const std::string& driver) {
  return driver == "DXF" ? "EOF" : "";
}

bool ends_with(const std::string& path, std::string_view end) {
  constexpr std::streamoff kTail = 16;
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - kTail));
  std::string tail;
  for (char c = 0; in.get(c);) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) tail += c;
  }
  return tail.ends_with(end);
}

/// The name under which a file of the output is published. The file that was asked for gets the
/// caller's own name. GDAL writes X.shp, X.shx and X.dbf for X.SHP: where the caller's extension is
/// in capitals, the files beside it get theirs in capitals too.
std::string published_name(const fs::path& written, const fs::path& wanted) {
  std::string extension = written.extension().string();
  if (extension == lower_extension(wanted.string())) return wanted.filename().string();
  const std::string asked = wanted.extension().string();
  const bool in_capitals = std::none_of(asked.begin(), asked.end(),
                                        [](unsigned char c) { return std::islower(c) != 0; });
  if (!in_capitals) return written.filename().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return written.stem().string() + extension;
}

OGRwkbGeometryType ogr_kind(GeometryKind kind) {
  switch (kind) {
    case GeometryKind::kPoint:
      return wkbPoint;
    case GeometryKind::kPointZ:
      return wkbPoint25D;
    case GeometryKind::kLine:
      return wkbLineString;
    case GeometryKind::kLineZ:
      return wkbLineString25D;
    case GeometryKind::kMultiLineZ:
      return wkbMultiLineString25D;
    case GeometryKind::kMultiPolygon:
      return wkbMultiPolygon;
  }
  return wkbUnknown;
}

/// Puts a path of a geometry into a line or a ring.
void set_path(OGRSimpleCurve& curve, const Geometry& geometry, std::size_t path) {
  const std::size_t first = path == 0 ? 0 : geometry.paths[path - 1];
  const std::size_t count = geometry.paths[path] - first;
  std::vector<OGRRawPoint> raw(count);
  std::transform(geometry.points.begin() + static_cast<std::ptrdiff_t>(first),
                 geometry.points.begin() + static_cast<std::ptrdiff_t>(first + count), raw.begin(),
                 [](const MapPoint& p) { return OGRRawPoint(p.x, p.y); });
  curve.setPoints(static_cast<int>(count), raw.data(),
                  geometry.heights.empty() ? nullptr : geometry.heights.data() + first);
}

std::unique_ptr<OGRGeometry> ogr_geometry(const Geometry& geometry, GeometryKind kind) {
  if (kind == GeometryKind::kPoint || kind == GeometryKind::kPointZ) {
    auto point = std::make_unique<OGRPoint>(geometry.points[0].x, geometry.points[0].y);
    if (kind == GeometryKind::kPointZ) point->setZ(geometry.heights[0]);
    return point;
  }
  if (kind == GeometryKind::kLine || kind == GeometryKind::kLineZ) {
    auto line = std::make_unique<OGRLineString>();
    set_path(*line, geometry, 0);
    return line;
  }
  if (kind == GeometryKind::kMultiLineZ) {
    auto lines = std::make_unique<OGRMultiLineString>();
    for (std::size_t path = 0; path < geometry.paths.size(); ++path) {
      auto line = std::make_unique<OGRLineString>();
      set_path(*line, geometry, path);
      lines->addGeometryDirectly(line.release());
    }
    lines->set3D(TRUE);
    return lines;
  }
  auto polygons = std::make_unique<OGRMultiPolygon>();
  std::size_t path = 0;
  for (const std::size_t end : geometry.polygons) {
    auto polygon = std::make_unique<OGRPolygon>();
    for (; path < end; ++path) {
      auto ring = std::make_unique<OGRLinearRing>();
      set_path(*ring, geometry, path);
      polygon->addRingDirectly(ring.release());
    }
    polygons->addGeometryDirectly(polygon.release());
  }
  return polygons;
}

class OgrWriter final : public LayerWriter {
 public:
  OgrWriter(std::string path, bool overwrite, const VectorFile::Layer& layer, std::string driver);

  void add(const Geometry& geometry, std::span<const VectorFile::Value> values) override;
  void publish() override;

 private:
  void close();

  std::string path_, target_;  ///< `path_` as given, for messages; `target_` where it leads.
  TemporaryPath folder_;       ///< For the work.
  bool overwrite_;
  std::string driver_;
  GeometryKind kind_;
  std::unique_ptr<GDALDataset, void (*)(GDALDataset*)> dataset_;
  OGRLayer* layer_ = nullptr;
  std::vector<int> fields_;  ///< Places of the layer's fields in a feature.
};

/// The name of a folder beside a file.
std::string work_folder(const fs::path& wanted) {
  return (wanted.parent_path() /
          ("." + wanted.filename().string() + ".tmp" + std::to_string(getpid())))
      .string();
}

OgrWriter::OgrWriter(std::string path, bool overwrite, const VectorFile::Layer& layer,
                     std::string driver)
    : path_(std::move(path)),
      target_(target_of(path_, overwrite)),
      folder_(work_folder(target_)),
      overwrite_(overwrite),
      driver_(std::move(driver)),
      kind_(layer.geometry),
      dataset_(nullptr, [](GDALDataset* d) {
        if (d != nullptr) GDALClose(d);
      }) {
  if (target_ != path_ && lower_extension(path_) == ".shp") {
    folder_.keep();
    refuse("is a link, and a shapefile is several files; give the name it leads to", path_);
  }
  if (::mkdir(folder_.path().c_str(), 0777) != 0) {
    const int failure = errno;
    folder_.keep();  // what is there is not ours
    throw system_error(failure, "cannot create the output", path_);
  }
  const std::string target = (fs::path(folder_.path()) / fs::path(path_).filename()).string();
  GDALDriver& by = driver_named(driver_.c_str());
  const UnsafeSqlite unsafe;
  CPLErrorReset();
  CPLStringList creation;
  for (const std::string& option : layer.creation) creation.AddString(option.c_str());
  dataset_.reset(by.Create(target.c_str(), 0, 0, 0, GDT_Unknown, creation.List()));
  const std::unique_ptr<OGRSpatialReference> reference = reference_of(layer.crs.wkt);
  if (dataset_) {
    layer_ = dataset_->CreateLayer(layer.name, reference.get(), ogr_kind(kind_), nullptr);
  }
  if (layer_ == nullptr) throw gdal_failure("cannot create the output", path_);
  create_fields(*layer_, layer, path_);
  for (const VectorFile::Field& field : layer.fields)
    fields_.push_back(layer_->GetLayerDefn()->GetFieldIndex(field.name.c_str()));
  if (dataset_->TestCapability(ODsCTransactions) != 0 &&
      dataset_->StartTransaction() != OGRERR_NONE) {
    throw gdal_failure("cannot begin to write the output", path_);
  }
}

void OgrWriter::add(const Geometry& geometry, std::span<const VectorFile::Value> values) {
  OGRFeature feature(layer_->GetLayerDefn());
  for (std::size_t i = 0; i < values.size(); ++i) {
    set_field(feature, fields_[i], values[i]);
  }
  feature.SetGeometryDirectly(ogr_geometry(geometry, kind_).release());
  if (layer_->CreateFeature(&feature) != OGRERR_NONE) {
    throw gdal_failure("cannot write a feature", path_);
  }
}

/// Closes the dataset, and throws when that fails. GDAL's drivers write most of a file when they
/// close it, and some report a full disk only by an error message then.
void OgrWriter::close() {
  const UnsafeSqlite unsafe;
  CPLErrorReset();
  if (dataset_->TestCapability(ODsCTransactions) != 0 &&
      dataset_->CommitTransaction() != OGRERR_NONE) {
    throw gdal_failure("cannot write the output", path_);
  }
  dataset_.reset();
  if (CPLGetLastErrorType() == CE_Failure) throw gdal_failure("cannot write the output", path_);
  if (!ends_with((fs::path(folder_.path()) / fs::path(path_).filename()).string(),
                 end_of_whole_file(driver_))) {
    throw gdal_failure("cannot write the output", path_);
  }
}

void OgrWriter::publish() {
  close();
  require_memory_given(path_);
  // A shapefile is several files. The one that was asked for gets its name last, so that what is
  // there is complete.
  const fs::path target(target_);
  std::vector<std::pair<std::string, fs::path>> files;  // by the names that they get
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    const bool is_itself = entry.path().filename() == fs::path(path_).filename();
    files.emplace_back(
        is_itself ? target.filename().string() : published_name(entry.path(), target),
        entry.path());
  }
  std::sort(files.begin(), files.end(), [&](const auto& a, const auto& b) {
    const bool a_last = a.first == target.filename();
    const bool b_last = b.first == target.filename();
    return a_last != b_last ? b_last : a < b;
  });
  if (overwrite_) remove_companions(target_);
  for (const auto& [name, file] : files) {
    move_into_place(file.string(), (target.parent_path() / name).string(), overwrite_);
  }
}

}  // namespace

std::unique_ptr<LayerWriter> make_ogr_writer(const std::string& path, bool overwrite,
                                             const VectorFile::Layer& layer,
                                             const std::string& driver) {
  return std::make_unique<OgrWriter>(path, overwrite, layer, driver);
}

}  // namespace ptin::tools
