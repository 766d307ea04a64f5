// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/vector_file.h"

#include <algorithm>
#include <array>
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
#include "tools/output/companion_files.h"
#include "tools/output/file_name.h"
#include "tools/output/gdal_output.h"
#include "tools/output/output_file.h"
#include "tools/refused_memory.h"

namespace ptin::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::array<VectorFormat, 4> kVectorFormats = {
    {{"gpkg", "GPKG"}, {"fgb", "FlatGeobuf"}, {"geojson", "GeoJSON"}, {"shp", "ESRI Shapefile"}}};
constexpr const VectorFormat& kGeoJson = kVectorFormats[2];

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
  if (driver == kGeoJson.driver) return "]}";
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

}  // namespace

std::string known_vector_extensions() {
  std::string known;
  for (const VectorFormat& f : kVectorFormats)
    known.append(known.empty() ? "." : ", .").append(f.extension);
  return known;
}

const VectorFormat* find_vector_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".json") return &kGeoJson;
  for (const VectorFormat& f : kVectorFormats) {
    if (extension == std::string(".").append(f.extension)) return &f;
  }
  return nullptr;
}

void refuse_extension(const std::string& path, const std::string& known) {
  const std::string extension = lower_extension(path);
  const std::string what = extension.empty() ? std::string("the name has no extension")
                                             : std::string("unknown extension ").append(extension);
  refuse(what + "; known are " + known + ", and - for GeoJSON on stdout", path);
}

const VectorFormat& vector_format_of(const std::string& path) {
  if (path == "-") return kGeoJson;
  if (const VectorFormat* format = find_vector_format(path)) return *format;
  refuse_extension(path, known_vector_extensions());
}

VectorFile::VectorFile(std::string path, bool overwrite, const Layer& layer)
    : path_(std::move(path)), overwrite_(overwrite), dataset_(nullptr, [](GDALDataset* d) {
        if (d != nullptr) GDALClose(d);
      }) {
  driver_ = layer.driver != nullptr ? layer.driver : vector_format_of(path_).driver;
  std::string target = "/vsistdout/";
  if (path_ != "-") {
    check_output(path_, overwrite_);
    target_ = output_target(path_);
    if (target_ != path_ && lower_extension(path_) == ".shp") {
      refuse("is a link, and a shapefile is several files; give the name it leads to", path_);
    }
    const fs::path wanted(target_);
    folder_.emplace((wanted.parent_path() /
                     ("." + wanted.filename().string() + ".tmp" + std::to_string(getpid())))
                        .string());
    if (::mkdir(folder_->path().c_str(), 0777) != 0) {
      const int failure = errno;
      folder_->keep();  // what is there is not ours
      throw system_error(failure, "cannot create the output", path_);
    }
    target = (fs::path(folder_->path()) / fs::path(path_).filename()).string();
  }
  try {
    GDALDriver& driver = driver_named(driver_.c_str());
    const UnsafeSqlite unsafe;
    CPLErrorReset();
    CPLStringList creation;
    for (const std::string& option : layer.creation) creation.AddString(option.c_str());
    dataset_.reset(driver.Create(target.c_str(), 0, 0, 0, GDT_Unknown, creation.List()));
    const std::unique_ptr<OGRSpatialReference> reference = reference_of(layer.crs_wkt);
    if (dataset_) {
      layer_ = dataset_->CreateLayer(layer.name, reference.get(), layer.geometry, nullptr);
    }
    if (layer_ == nullptr) throw gdal_failure("cannot create the output", path_);
    create_fields(*layer_, layer, path_);
    for (const Field& field : layer.fields)
      fields_.push_back(layer_->GetLayerDefn()->GetFieldIndex(field.name.c_str()));
    if (dataset_->TestCapability(ODsCTransactions) != 0 &&
        dataset_->StartTransaction() != OGRERR_NONE) {
      throw gdal_failure("cannot begin to write the output", path_);
    }
  } catch (...) {
    dataset_.reset();  // before its folder goes
    throw;
  }
}

VectorFile::~VectorFile() { dataset_.reset(); }

void VectorFile::add(std::unique_ptr<OGRGeometry> geometry, std::span<const Value> values) {
  OGRFeature feature(layer_->GetLayerDefn());
  for (std::size_t i = 0; i < values.size(); ++i) {
    set_field(feature, fields_[i], values[i]);
  }
  feature.SetGeometryDirectly(geometry.release());
  if (layer_->CreateFeature(&feature) != OGRERR_NONE) {
    throw gdal_failure("cannot write a feature", path_);
  }
}

/// Closes the dataset, and throws when that fails. GDAL's drivers write most of a file when they
/// close it, and some report a full disk only by an error message then.
void VectorFile::close() {
  const UnsafeSqlite unsafe;
  CPLErrorReset();
  if (dataset_->TestCapability(ODsCTransactions) != 0 &&
      dataset_->CommitTransaction() != OGRERR_NONE) {
    throw gdal_failure("cannot write the output", path_);
  }
  dataset_.reset();
  if (CPLGetLastErrorType() == CE_Failure) throw gdal_failure("cannot write the output", path_);
  if (folder_ && !ends_with((fs::path(folder_->path()) / fs::path(path_).filename()).string(),
                            end_of_whole_file(driver_))) {
    throw gdal_failure("cannot write the output", path_);
  }
}

void VectorFile::publish() {
  close();
  require_memory_given(path_);
  if (!folder_) return;
  // A shapefile is several files. The one that was asked for gets its name last, so that what is
  // there is complete.
  const fs::path target(target_);
  std::vector<std::pair<std::string, fs::path>> files;  // by the names that they get
  for (const auto& entry : fs::directory_iterator(folder_->path())) {
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

std::unique_ptr<OGRGeometry> line_geometry(std::span<const MapPoint> points, const double* z) {
  auto line = std::make_unique<OGRLineString>();
  std::vector<OGRRawPoint> raw(points.size());
  std::transform(points.begin(), points.end(), raw.begin(),
                 [](const MapPoint& p) { return OGRRawPoint(p.x, p.y); });
  const std::vector<double> heights(z != nullptr ? points.size() : 0, z != nullptr ? *z : 0.0);
  line->setPoints(static_cast<int>(raw.size()), raw.data(),
                  z != nullptr ? heights.data() : nullptr);
  return line;
}

}  // namespace ptin::tools
