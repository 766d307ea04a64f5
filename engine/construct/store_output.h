// SPDX-License-Identifier: GPL-3.0-or-later
//
// From finished segments and T0 to a published store.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/build.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/raster/raster_kept.h"
#include "engine/construct/stored_detail.h"
#include "engine/construct/tile_tasks/segment_output.h"
#include "engine/mesh/tin.h"
#include "storage/store_writer.h"

namespace ptin {

/// Makes pages of a store and puts them to their place in its work folder, in whatever process:
/// leaves out the finest detail (BuildOptions::max_error) and adds the rounding of heights.
class StorePacker final : public SegmentPacker {
 public:
  /// @param files        Borrowed.
  /// @param work_folder  As StoreWriterOptions; its StoreWriter was made already.
  /// @param is_raster    The source is one, and its samples will be added.
  StorePacker(const BuildOptions& options, const TerrainFrame& frame, bool is_raster,
              FileLayer& files, std::string work_folder);

  [[nodiscard]] PreparedSegment prepare(StarredRecords& records) const override;
  void place(std::span<const std::byte> pages, std::uint64_t offset) const override;
  [[nodiscard]] const StoredDetail& detail() const noexcept { return detail_; }
  [[nodiscard]] const PageForm& form() const noexcept { return form_; }

 private:
  StoredDetail detail_;
  HeightEncoding heights_;
  PageForm form_;
  std::uint32_t page_bytes_;
  FileLayer& files_;
  std::string work_folder_;
};

/// Takes segments of records with their final attributes, and publishes. Destroyed before
/// publish(), it leaves nothing behind but what is in the work folder.
class StoreOutput final : public SegmentOutput {
 public:
  /// @param is_raster           As StorePacker.
  /// @param files, work_folder  As StoreWriterOptions.
  /// @throws Error as StoreWriter::create
  StoreOutput(const std::string& path, const BuildOptions& options, bool overwrite,
              const TerrainFrame& frame, bool is_raster, FileLayer& files,
              const std::string& work_folder);

  [[nodiscard]] const SegmentPacker& packer() const override { return packer_; }
  /// @throws Error as StoreWriter::add_placed
  void add(const PreparedSegment& segment) override;
  [[nodiscard]] std::uint64_t page_bytes() const override;
  [[nodiscard]] nlohmann::json position() const override;
  void sync() override { writer_->sync(); }
  void resume(const nlohmann::json& position) override;

  /// Has the samples of a raster added, where each of them is a vertex of the file with its own height.
  /// @param add  Tells what is kept of the raster, for the metadata.
  /// @throws Error as StoreWriter::add_floor
  void add_floor(const std::function<KeptRaster(StoreWriter&)>& add);

  /// @param t0       The coarsest TIN: the alive part of a mesh in which nothing more collapses.
  /// @param t0_deaths  One for each of t0.triangles, as deaths_of().
  /// @param inputs   Names for the metadata; their folders are left out, so that the bytes do not
  /// depend on them.
  /// @param report   Counts for the metadata; receives records, t0_vertices, max_rank, file_bytes.
  /// @throws Error as StoreWriter::publish
  void publish(const Tin& t0, std::span<const float> t0_deaths,
               const std::vector<std::string>& inputs, BuildReport& report);

 private:
  std::string path_;
  BuildOptions options_;
  TerrainFrame frame_;
  std::unique_ptr<StoreWriter> writer_;  ///< Made before the packer, which finds its file.
  StorePacker packer_;
  double base_error_ = 0.0;
  double base_deviation_ = 0.0;
  std::uint64_t void_records_ = 0;    ///< Records that make a void triangle or vertex.
  std::optional<KeptRaster> raster_;  ///< Whose samples the file has.
};

/// The alive part of a mesh as the store keeps it, in the order of the vertices.
[[nodiscard]] CoarsestTin coarsest_tin(const Tin& tin);

/// Deaths of the triangles of coarsest_tin(), as the file has them.
/// @param deaths  One for each of tin.triangles.
[[nodiscard]] std::vector<float> coarsest_deaths(const Tin& tin, std::span<const float> deaths,
                                                 const StoredDetail& detail);

}  // namespace ptin
