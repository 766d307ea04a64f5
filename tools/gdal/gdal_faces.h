// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a driver overrides of GDAL's data sets and layers, under one signature for all versions: 3.11 has
// drivers tell extents by another function, 3.12 asks questions of const objects and wraps the six
// numbers of a raster's place, 3.13 gives lists of metadata that nobody may change.
#pragma once

#include <array>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

namespace ptin::tools {

class DatasetFace : public GDALDataset {
 public:
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 12, 0)
  CPLErr GetGeoTransform(GDALGeoTransform& transform) const override { return put(transform); }
  int GetLayerCount() const override { return layer_count(); }
  const OGRLayer* GetLayer(int i) const override { return layer(i); }
#else
  CPLErr GetGeoTransform(double* transform) override { return put(transform); }
  int GetLayerCount() override { return layer_count(); }
  OGRLayer* GetLayer(int i) override { return layer(i); }
#endif

 private:
  [[nodiscard]] virtual std::array<double, 6> geotransform() const = 0;
  [[nodiscard]] virtual int layer_count() const = 0;
  /// Null where there is no such layer.
  [[nodiscard]] virtual OGRLayer* layer(int i) const = 0;

  template <class Numbers>
  CPLErr put(Numbers& transform) const {
    const std::array<double, 6> numbers = geotransform();
    for (int i = 0; i < 6; ++i) transform[i] = numbers[static_cast<std::size_t>(i)];
    return CE_None;
  }
};

class LayerFace : public OGRLayer {
 public:
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 12, 0)
  const OGRFeatureDefn* GetLayerDefn() const override { return &definition(); }
  int TestCapability(const char* name) const override { return static_cast<int>(is_able(name)); }
#else
  OGRFeatureDefn* GetLayerDefn() override { return &definition(); }
  int TestCapability(const char* name) override { return static_cast<int>(is_able(name)); }
#endif

#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 11, 0)
  OGRErr IGetExtent(int /*field*/, OGREnvelope* box, bool /*is_forced*/) override {
#else
  using OGRLayer::GetExtent;
  OGRErr GetExtent(OGREnvelope* box, int /*is_forced*/) override {
#endif
    *box = extent();
    return OGRERR_NONE;
  }

#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 13, 0)
  using MetadataList = CSLConstList;
#else
  using MetadataList = char**;
#endif
  MetadataList GetMetadata(const char* domain) override {
    renew_metadata(domain);
    return OGRLayer::GetMetadata(domain);
  }
  const char* GetMetadataItem(const char* name, const char* domain) override {
    renew_metadata(domain);
    return OGRLayer::GetMetadataItem(name, domain);
  }

 private:
  [[nodiscard]] virtual OGRFeatureDefn& definition() const = 0;
  [[nodiscard]] virtual OGREnvelope extent() const = 0;
  [[nodiscard]] virtual bool is_able(const char* capability) const = 0;
  /// Called before metadata of a domain are read; null is the one without a name.
  virtual void renew_metadata(const char* domain) = 0;
};

}  // namespace ptin::tools
