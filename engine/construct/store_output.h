// SPDX-License-Identifier: GPL-3.0-or-later
//
// From finished segments and T0 to a published store.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/build.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/hierarchy/segment_output.h"
#include "engine/construct/stored_detail.h"
#include "engine/mesh/tin.h"
#include "storage/store_writer.h"

namespace ptin {

/// Takes segments of records with their final attributes, leaves out the finest detail
/// (BuildOptions::max_error), adds the rounding of heights, and publishes. Destroyed before
/// publish(), it leaves nothing behind, but for what is in a work folder.
class StoreOutput final : public SegmentOutput {
 public:
  /// @param files, work_folder  As StoreWriterOptions; without a folder nothing can be resumed.
  /// @throws Error as StoreWriter::create
  StoreOutput(const std::string& path, const BuildOptions& options, bool overwrite,
              const TerrainFrame& frame, FileLayer* files = nullptr,
              const std::string& work_folder = "");

  /// Packs one segment, which is changed in place, into pages, and notes what is told of it.
  [[nodiscard]] std::vector<std::byte> prepare(StarredRecords& records) const override;
  /// @throws Error as StoreWriter::add_segment
  void add(std::span<const std::byte> prepared) override;
  [[nodiscard]] nlohmann::json position() const override;
  void sync() override { writer_->sync(); }
  void resume(const nlohmann::json& position) override;

  /// @param t0       The coarsest TIN: the alive part of a mesh in which nothing more collapses.
  /// @param t0_deaths  Beside t0.triangles, as deaths_of().
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
  StoredDetail detail_;
  std::unique_ptr<StoreWriter> writer_;
  double base_error_ = 0.0;
  double base_deviation_ = 0.0;
  std::uint64_t records_ = 0;
  std::uint16_t max_rank_ = 0;
  std::uint64_t void_records_ = 0;  ///< Records that make a void triangle or vertex.
};

/// The options that decide the bytes of a file, as its metadata has them.
[[nodiscard]] nlohmann::json options_json(const BuildOptions& options);

/// The alive part of a mesh as the store keeps it, in the order of the vertices.
[[nodiscard]] CoarsestTin coarsest_tin(const Tin& tin);

/// Beside the triangles of coarsest_tin(): their deaths as the file has them.
/// @param deaths  Beside tin.triangles.
[[nodiscard]] std::vector<float> coarsest_deaths(const Tin& tin, std::span<const float> deaths,
                                                 const StoredDetail& detail);

}  // namespace ptin
