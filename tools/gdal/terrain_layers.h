// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layers of a terrain. A spatial filter is the window that the terrain is asked about.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include <ogrsf_frmts.h>

#include "engine/query/questions.h"
#include "tools/gdal/gdal_faces.h"

namespace ptin::tools {

class TerrainDataset;

/// A layer whose features are found when they are first read, all that meet the filter's box at once,
/// and again when that box is another one. GetFeature() answers from what was found last, whatever the
/// filters are now, since a number of an isoline means nothing elsewhere; a triangle is looked for at
/// its place, too. What was found stays. Cost: it looks at the numbers of all that was found.
class FoundLayer : public LayerFace, public OGRGetNextFeatureThroughRaw<FoundLayer> {
 public:
  ~FoundLayer() override { definition_->Release(); }
  void ResetReading() override { next_ = 0; }
  // NOLINTNEXTLINE(readability-identifier-naming): GDAL's name
  OGRFeature* GetNextRawFeature();
  OGRFeature* GetFeature(GIntBig wanted) override;
  DEFINE_GET_NEXT_FEATURE_THROUGH_RAW(FoundLayer)

 protected:
  FoundLayer(const TerrainDataset& dataset, const char* name, OGRwkbGeometryType type);
  [[nodiscard]] const TerrainDataset& dataset() const noexcept { return dataset_; }
  [[nodiscard]] OGRFeatureDefn& definition() const override { return *definition_; }
  /// The feature of a number among those that were found last, or null.
  [[nodiscard]] std::unique_ptr<OGRFeature> found_feature(GIntBig wanted) const;

 private:
  [[nodiscard]] OGREnvelope extent() const override;
  [[nodiscard]] bool is_able(const char* capability) const override;
  /// What is certified of the features that meet the filter.
  void renew_metadata(const char* domain) override;
  /// The filter's box within the terrain; none: it lies elsewhere.
  [[nodiscard]] std::optional<OGREnvelope> box_of_filter() const;
  /// Finds what meets the filter's box, unless it was found last. False: the box lies elsewhere.
  [[nodiscard]] bool find_in_filter();
  [[nodiscard]] std::unique_ptr<OGRFeature> feature(std::size_t i) const;
  /// The level at which a window is asked about.
  [[nodiscard]] virtual DetailRequest detail(const Window& window) const = 0;
  /// Finds what meets a window of the terrain, and forgets what was found before.
  virtual void find(const Window& window) = 0;
  /// The feature of a number that need not have been found, or null; keeps what was found.
  [[nodiscard]] virtual std::unique_ptr<OGRFeature> feature_elsewhere(GIntBig /*wanted*/) {
    return nullptr;
  }
  /// How many features were found.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// The number of a feature.
  [[nodiscard]] virtual GIntBig number(std::size_t i) const = 0;
  /// Fills in a feature's geometry and fields.
  virtual void fill(std::size_t i, OGRFeature& feature) const = 0;

  const TerrainDataset& dataset_;
  OGRFeatureDefn* definition_;
  std::optional<OGREnvelope> found_;  ///< What was found lies here.
  std::size_t next_ = 0;
};

/// "triangles": those of the surface as polygons, since not all programs know OGR's type for
/// triangles. Without ERROR such that about 50 000 vertices meet the filter. A triangle has the same
/// number whatever the filter is.
class TriangleLayer final : public FoundLayer {
 public:
  explicit TriangleLayer(const TerrainDataset& dataset)
      : FoundLayer(dataset, "triangles", wkbPolygon25D) {}

 private:
  [[nodiscard]] DetailRequest detail(const Window& window) const override;
  void find(const Window& window) override;
  [[nodiscard]] std::unique_ptr<OGRFeature> feature_elsewhere(GIntBig wanted) override;
  [[nodiscard]] std::size_t size() const override { return surface_.size(); }
  [[nodiscard]] GIntBig number(std::size_t i) const override;
  void fill(std::size_t i, OGRFeature& feature) const override;

  std::optional<TinParts> parts_;  ///< What the triangles lie in.
  const Tin* tin_ = nullptr;
  std::vector<TriangleId> surface_;
};

/// "isolines": LineStringZ and their height, `elev`, as ptin isoline has it; higher ground lies to
/// the right. Exact without ERROR. Lines are cut at the filter's box, and numbered from 0 there.
class IsolineLayer final : public FoundLayer {
 public:
  /// REQUIRES: the dataset has an INTERVAL.
  explicit IsolineLayer(const TerrainDataset& dataset);

 private:
  [[nodiscard]] DetailRequest detail(const Window& window) const override;
  void find(const Window& window) override;
  [[nodiscard]] std::size_t size() const override { return lines_ ? lines_->size() : 0; }
  [[nodiscard]] GIntBig number(std::size_t i) const override { return static_cast<GIntBig>(i); }
  void fill(std::size_t i, OGRFeature& feature) const override;

  std::optional<Isolines> lines_;
};

}  // namespace ptin::tools
