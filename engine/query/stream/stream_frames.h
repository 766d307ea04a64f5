// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the frames of a stream come from: all of the terrain in memory, or part after part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/stream/frame_coder.h"
#include "engine/query/stream/frame_cuts.h"
#include "engine/query/stream/stream_writer.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// A stream of a terrain, frame by frame, as cells write it down. Made, it knows how many splits
/// there are and where frames end. Threads: one owner.
class StreamFrames {
 public:
  StreamFrames() = default;
  StreamFrames(const StreamFrames&) = delete;
  StreamFrames& operator=(const StreamFrames&) = delete;
  virtual ~StreamFrames() = default;

  /// Vertices of the mesh to which the first split is applied, and its digest.
  [[nodiscard]] virtual std::uint64_t base_vertices() const = 0;
  [[nodiscard]] virtual std::uint64_t base_digest() const = 0;
  [[nodiscard]] virtual const FrameCuts& cuts() const = 0;

  /// Does what has to be done before the first frame.
  /// @return the vertices of the base in each cell
  /// @throws Error corruption, io_error, resource_exhausted, cancelled
  [[nodiscard]] virtual std::vector<std::uint64_t> begin() = 0;
  /// Puts what the cells wrote of a frame in the place of what `coded` held. Frames in their order.
  /// @throws Error as begin()
  virtual void take(std::size_t frame, std::vector<std::byte>& coded) = 0;
  /// Counts the vertices of the frame that was taken last.
  virtual void count_vertices(std::size_t frame, FrameCoder& coder) const = 0;
  /// Digest of the vertices of all splits, once the last frame was taken.
  [[nodiscard]] virtual std::uint64_t digest() const = 0;
};

/// Bytes that sending takes at most where all is in memory at once, beside T0.
[[nodiscard]] std::uint64_t bytes_of_sending(std::uint64_t base_vertices,
                                             std::uint64_t splits) noexcept;

/// Records, mesh and all in memory: one cell.  @param context  Borrowed.
/// @throws Error as write_stream()
[[nodiscard]] std::unique_ptr<StreamFrames> whole_stream(const OpenedTerrain& terrain,
                                                         const StreamRequest& request,
                                                         QueryContext& context);

/// Cell after cell, through temporary files. REQUIRES: a folder.
/// @param context  Borrowed, as `files`: those of the temporary files.
/// @throws Error as write_stream(); io_error, resource_exhausted (the disk is full)
[[nodiscard]] std::unique_ptr<StreamFrames> stream_in_parts(const OpenedTerrain& terrain,
                                                            const StreamRequest& request,
                                                            QueryContext& context,
                                                            FileLayer& files = FileLayer::system());

}  // namespace ptin
