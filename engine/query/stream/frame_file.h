// SPDX-License-Identifier: GPL-3.0-or-later
//
// What cells wrote down, in a temporary file until its frame is coded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "storage/file/file_layer.h"

namespace ptin {

/// Pieces of frames: added in any order, taken frame by frame. The file has no name, so it goes with
/// the process. Threads: add() from any number at once.
class FrameFile {
 public:
  /// @param folder  Where the file is made.
  /// @throws Error not_found (no such folder), io_error, resource_exhausted
  FrameFile(FileLayer& files, const std::string& folder, std::size_t frames);

  /// @throws Error io_error, resource_exhausted (the disk is full)
  void add(std::size_t frame, std::span<const std::byte> bytes);
  /// All that was added to a frame, in the place of what `out` held.
  /// @throws Error io_error; corruption  the file is not what was written
  void take(std::size_t frame, std::vector<std::byte>& out) const;

 private:
  struct Piece {
    std::uint64_t offset = 0, bytes = 0;  ///< 0 bytes: there is none.
  };
  /// Before the bytes of a piece. The pieces of a frame are a chain, the last one first.
  struct PieceHead {
    Piece before;
    std::uint64_t checksum;
  };
  [[nodiscard]] static std::uint64_t checksum_of_piece(const Piece& before,
                                                       std::span<const std::byte> bytes);

  ScratchFile file_;
  std::string folder_;
  std::mutex mutex_;
  std::uint64_t end_ = 0;
  std::vector<Piece> last_;  ///< Of each frame.
};

}  // namespace ptin
