// SPDX-License-Identifier: GPL-3.0-or-later
//
// GeoPackage and FlatGeobuf: a feature a triangle, with its slope and aspect.
#include <array>
#include <cstring>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "tools/export/tin_sink.h"
#include "tools/output/gdal_output.h"
#include "tools/output/pending_file.h"
#include "tools/slope.h"

namespace ptin::tools {

namespace {

constexpr std::uint64_t kFeaturesATransaction = 100'000;
constexpr std::uint64_t kIndexBytesATriangle = 128;  // FlatGeobuf's items, while it sorts them

struct FeatureDestroyer {
  void operator()(OGRFeature* f) const { OGRFeature::DestroyFeature(f); }
};

/// ISO WKB of POLYGON Z with one closed ring of four points: made once, filled for each triangle.
class TriangleWkb {
 public:
  TriangleWkb() {
    put(0, std::uint8_t{1});  // little-endian
    put(1, std::uint32_t{1003});
    put(5, std::uint32_t{1});
    put(9, std::uint32_t{4});
  }
  void set(std::size_t i, const TinPatch::Point& p) {
    std::memcpy(bytes_.data() + kHead + i * sizeof p, p.data(), sizeof p);
  }
  [[nodiscard]] const std::uint8_t* data() const { return bytes_.data(); }
  [[nodiscard]] static constexpr std::size_t size() { return kHead + 4 * sizeof(TinPatch::Point); }

 private:
  static constexpr std::size_t kHead = 13;
  template <typename T>
  void put(std::size_t at, T value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  std::array<std::uint8_t, kHead + 4 * sizeof(TinPatch::Point)> bytes_{};
};

class OgrSink final : public TinSink {
 public:
  OgrSink(const SinkTarget& target, const char* driver_name, bool has_index, bool has_transactions)
      : pending_(target.path, target.overwrite),
        has_transactions_(has_transactions),
        slope_in_percent_(target.slope_in_percent),
        per_map_unit_(ground_of(target.crs).per_map_unit) {
    GDALDriver& driver = driver_named(driver_name);
    CPLErrorReset();
    dataset_.reset(driver.Create(pending_.temporary().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!dataset_) throw gdal_failure("cannot create the output", pending_.path());
    OGRSpatialReference srs;
    srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const bool has_srs =
        !target.crs.wkt.empty() && srs.importFromWkt(target.crs.wkt.c_str()) == OGRERR_NONE;
    CPLStringList options;
    options.SetNameValue("SPATIAL_INDEX", has_index ? "YES" : "NO");
    layer_ = dataset_->CreateLayer("triangles", has_srs ? &srs : nullptr, wkbPolygon25D, options);
    if (layer_ == nullptr) throw gdal_failure("cannot create a layer", pending_.path());
    for (const char* name : {"slope", "aspect"}) {
      OGRFieldDefn field(name, OFTReal);
      if (layer_->CreateField(&field) != OGRERR_NONE)
        throw gdal_failure("cannot create a field", pending_.path());
    }
    feature_.reset(OGRFeature::CreateFeature(layer_->GetLayerDefn()));
    begin();
  }

  void add(const TinPatch& patch) override {
    for (const auto& triangle : patch.triangles) {
      for (std::size_t i = 0; i < 4; ++i) wkb_.set(i, patch.point(triangle[i % 3]));
      set_fields(patch, triangle);
      write();
    }
  }

  void publish() override {
    commit();
    feature_.reset();
    CPLErrorReset();
    const bool was_disk_full = is_disk_full(pending_.path());
    GDALClose(dataset_.release());  // Has no result; GDAL's last error says.
    if (CPLGetLastErrorType() >= CE_Failure || !is_complete())
      throw gdal_failure("cannot finish the output", pending_.path(), was_disk_full);
    pending_.publish();
  }

 private:
  void set_fields(const TinPatch& patch, const std::array<TinPatch::Corner, 3>& triangle) {
    std::array<CodedPoint, 3> corners{};
    MapPoint middle;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& v = patch.tin->vertices[triangle[i].local];
      corners[i] = {v.position, patch.facts->heights.code(v.height)};
      const TinPatch::Point p = patch.point(triangle[i]);
      middle = {middle.x + p[0] / 3, middle.y + p[1] / 3};
    }
    const Slope slope = slope_of(normal_of(corners), *patch.facts, per_map_unit_(middle));
    feature_->SetField(0, slope_in_percent_ ? percent_of(slope) : degrees_of(slope));
    if (const std::optional<double> aspect = aspect_of(slope)) {
      feature_->SetField(1, *aspect);
    } else {
      feature_->SetFieldNull(1);
    }
  }
  void write() {
    OGRGeometry* geometry = nullptr;
    if (OGRGeometryFactory::createFromWkb(wkb_.data(), nullptr, &geometry, TriangleWkb::size()) !=
        OGRERR_NONE) {
      throw Error(ErrorCode::internal, "a triangle is no geometry", pending_.path());
    }
    feature_->SetGeometryDirectly(geometry);
    feature_->SetFID(OGRNullFID);
    if (layer_->CreateFeature(feature_.get()) != OGRERR_NONE)
      throw gdal_failure("cannot write a triangle", pending_.path());
    if (++features_ % kFeaturesATransaction == 0) {
      commit();
      begin();
    }
  }
  /// Looks whether all features were written. A database (GeoPackage) says itself what it could not
  /// write. GDAL does not notice every short write to a plain file, so its features are read back
  /// and counted.
  [[nodiscard]] bool is_complete() const {
    if (has_transactions_) return true;
    const GDALDatasetUniquePtr written(
        GDALDataset::Open(pending_.temporary().c_str(), GDAL_OF_VECTOR));
    if (!written || written->GetLayerCount() != 1) return false;
    OGRLayer* layer = written->GetLayer(0);
    std::uint64_t found = 0;
    while (const std::unique_ptr<OGRFeature, FeatureDestroyer> feature{layer->GetNextFeature()}) {
      ++found;
    }
    return found == features_;
  }
  void begin() {
    if (has_transactions_ && dataset_->StartTransaction() != OGRERR_NONE)
      throw gdal_failure("cannot write the output", pending_.path());
  }
  void commit() {
    if (has_transactions_ && dataset_->CommitTransaction() != OGRERR_NONE)
      throw gdal_failure("cannot write the output", pending_.path());
  }

  PendingFile pending_;
  bool has_transactions_;
  bool slope_in_percent_;
  std::function<MapPoint(MapPoint)> per_map_unit_;
  GDALDatasetUniquePtr dataset_;
  OGRLayer* layer_ = nullptr;
  std::unique_ptr<OGRFeature, FeatureDestroyer> feature_;
  TriangleWkb wkb_;
  std::uint64_t features_ = 0;
};

}  // namespace

std::unique_ptr<TinSink> make_geopackage_sink(const SinkTarget& target) {
  return std::make_unique<OgrSink>(target, "GPKG", true, true);
}

bool flatgeobuf_index_fits(const SinkTarget& target) {
  return target.most_triangles <= target.index_bytes / kIndexBytesATriangle;
}

std::unique_ptr<TinSink> make_flatgeobuf_sink(const SinkTarget& target) {
  return std::make_unique<OgrSink>(target, "FlatGeobuf", flatgeobuf_index_fits(target), false);
}

}  // namespace ptin::tools
