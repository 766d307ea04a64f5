// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layers of a terrain. A spatial filter is the window that the terrain is asked about.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include <ogrsf_frmts.h>

#include "engine/query/questions.h"

namespace ptin::tools {

class TerrainDataset;

/// A layer whose features are found when they are first read, all that meet the filter's box at once,
/// and again when that box is another one.
class FoundLayer : public OGRLayer, public OGRGetNextFeatureThroughRaw<FoundLayer> {
 public:
  ~FoundLayer() override { definition_->Release(); }
  void ResetReading() override { next_ = 0; }
  OGRFeatureDefn* GetLayerDefn() override { return definition_; }
  OGRErr GetExtent(OGREnvelope* extent, int is_forced) override;
  using OGRLayer::GetExtent;
  int TestCapability(const char* capability) override;
  // NOLINTNEXTLINE(readability-identifier-naming): GDAL's name
  OGRFeature* GetNextRawFeature();
  DEFINE_GET_NEXT_FEATURE_THROUGH_RAW(FoundLayer)

 protected:
  FoundLayer(const TerrainDataset& dataset, const char* name, OGRwkbGeometryType type);
  [[nodiscard]] const TerrainDataset& dataset() const noexcept { return dataset_; }

 private:
  /// Finds what meets a window of the terrain, and forgets what was found before.
  virtual void find(const Window& window) = 0;
  /// How many features were found.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Fills in a feature.
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
  void find(const Window& window) override;
  [[nodiscard]] std::size_t size() const override { return surface_.size(); }
  void fill(std::size_t i, OGRFeature& feature) const override;

  std::optional<TinParts> parts_;  ///< What the triangles lie in.
  const Tin* tin_ = nullptr;
  std::vector<TriangleId> surface_;
};

/// "isolines": LineStringZ and their height, `elev`, as ptin isoline has it; higher ground lies to
/// the right. Exact without ERROR. Lines are cut at the filter's box.
class IsolineLayer final : public FoundLayer {
 public:
  /// REQUIRES: the dataset has an INTERVAL.
  explicit IsolineLayer(const TerrainDataset& dataset);

 private:
  void find(const Window& window) override;
  [[nodiscard]] std::size_t size() const override { return lines_ ? lines_->size() : 0; }
  void fill(std::size_t i, OGRFeature& feature) const override;

  std::optional<Isolines> lines_;
};

}  // namespace ptin::tools
