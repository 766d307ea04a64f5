// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layers of a terrain. Programs know a feature by its number again, so one has the same number and
// the same geometry whatever the filter is.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <ogrsf_frmts.h>

#include "engine/query/questions.h"
#include "tools/gdal/gdal_faces.h"

namespace ptin::tools {

class TerrainDataset;

/// A layer whose features are found when they are first read, all that meet the filter's box at once,
/// and again when that box is another one. GetFeature() answers from what was found last, and else
/// looks where the number says; what was found stays. Cost: it looks at the numbers of all that was
/// found.
class FoundLayer : public LayerFace, public OGRGetNextFeatureThroughRaw<FoundLayer> {
 public:
  ~FoundLayer() override { definition_->Release(); }
  void ResetReading() override {
    next_ = 0;
    has_failed_ = false;
  }
  /// -1 where it cannot be told, and GDAL was told why.
  GIntBig GetFeatureCount(int is_forced) override;
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
  /// A feature with its geometry, its fields and this number.
  [[nodiscard]] std::unique_ptr<OGRFeature> feature(std::size_t i) const;

 private:
  [[nodiscard]] OGREnvelope extent() const override;
  [[nodiscard]] bool is_able(const char* capability) const override;
  /// What is certified of the features.
  void renew_metadata(const char* domain) override;
  /// The filter's box within the terrain; none: it lies elsewhere.
  [[nodiscard]] std::optional<OGREnvelope> box_of_filter() const;
  /// Finds what meets the filter's box, unless it was found last. False: the box lies elsewhere.
  [[nodiscard]] bool find_in_filter();
  /// The level of the layer.
  [[nodiscard]] virtual DetailRequest detail() const = 0;
  /// Finds what meets a window of the terrain, and perhaps more, and forgets what was found before.
  virtual void find(const Window& window) = 0;
  /// Whether a feature may meet a box.
  [[nodiscard]] virtual bool may_meet(std::size_t /*i*/, const OGREnvelope& /*box*/) const {
    return true;
  }
  /// The feature of a number that need not have been found, or null; keeps what was found.
  [[nodiscard]] virtual std::unique_ptr<OGRFeature> feature_elsewhere(GIntBig wanted) = 0;
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
  bool has_failed_ = false;
};

/// "triangles": those of the surface as polygons, since not all programs know OGR's type for
/// triangles. Without ERROR the TIN has about 50 000 vertices. A triangle's number is its place.
class TriangleLayer final : public FoundLayer {
 public:
  explicit TriangleLayer(const TerrainDataset& dataset)
      : FoundLayer(dataset, "triangles", wkbPolygon25D) {}

 private:
  [[nodiscard]] DetailRequest detail() const override;
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
/// the right. Exact without ERROR.
///
/// Lines are joined within a cell. A terrain is one cell where its level has up to 16 million vertices
/// (by MEMORY_MB), and else as many equal ones as make them so large: lines are then cut at their
/// borders. A line's number is that of its cell and, in the lower 32 bits, its own there.
class IsolineLayer final : public FoundLayer {
 public:
  /// REQUIRES: the dataset has an INTERVAL.
  explicit IsolineLayer(const TerrainDataset& dataset);

 private:
  /// The lines of one cell.
  struct CellLines {
    std::int64_t cell;
    std::size_t first;  ///< What was found has so many lines before them.
    Isolines lines;
  };
  /// A line of those that were found: the cell that holds it, and its number there.
  struct Place {
    const CellLines& cell;
    std::size_t line;
  };

  [[nodiscard]] DetailRequest detail() const override;
  void find(const Window& window) override;
  [[nodiscard]] bool may_meet(std::size_t i, const OGREnvelope& box) const override;
  [[nodiscard]] std::unique_ptr<OGRFeature> feature_elsewhere(GIntBig wanted) override;
  [[nodiscard]] std::size_t size() const override;
  [[nodiscard]] GIntBig number(std::size_t i) const override;
  void fill(std::size_t i, OGRFeature& feature) const override;

  /// Halves the longer sides until a cell has few enough vertices.
  void set_cells();
  [[nodiscard]] Window window_of_cell(std::int64_t cell) const;
  /// The numbers of the cells that meet a window.
  [[nodiscard]] std::vector<std::int64_t> cells_in(const Window& window) const;
  void find_cells(const std::vector<std::int64_t>& cells);
  [[nodiscard]] Place place_of(std::size_t i) const;

  std::int64_t columns_ = 1, rows_ = 1;   ///< Of cells.
  std::vector<CellLines> cells_;          ///< Those that were found.
  std::unique_ptr<IsolineLayer> beside_;  ///< Holds the cell that GetFeature() looked into last.
};

}  // namespace ptin::tools
