// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/frame_file.h"

#include <cstring>

#include "engine/error.h"
#include "storage/file/checksum.h"

namespace ptin {

std::uint64_t FrameFile::checksum_of_piece(const Piece& before, std::span<const std::byte> bytes) {
  struct {
    Piece before;
    std::uint64_t bytes;
  } both{before, checksum_of(bytes)};
  return checksum_of_object(both);
}

FrameFile::FrameFile(FileLayer& files, const std::string& folder, std::size_t frames)
    : file_(files, folder, "ptin-stream", true), folder_(folder), last_(frames) {}

void FrameFile::add(std::size_t frame, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  std::vector<std::byte> piece(sizeof(PieceHead) + bytes.size());
  PieceHead head{{}, 0};
  std::memcpy(piece.data() + sizeof head, bytes.data(), bytes.size());
  std::uint64_t offset = 0;
  {
    const std::lock_guard lock(mutex_);
    head.before = last_[frame];
    offset = end_;
    end_ += piece.size();
    last_[frame] = {offset, bytes.size()};
  }
  head.checksum = checksum_of_piece(head.before, bytes);
  std::memcpy(piece.data(), &head, sizeof head);
  file_.write_at(piece, offset);
}

void FrameFile::take(std::size_t frame, std::vector<std::byte>& out) const {
  out.clear();
  for (Piece piece = last_[frame]; piece.bytes != 0;) {
    PieceHead head{};
    const std::size_t before = out.size();
    out.resize(before + piece.bytes);
    const auto bytes = std::span(out).subspan(before);
    file_.read_at(std::as_writable_bytes(std::span(&head, 1)), piece.offset);
    file_.read_at(bytes, piece.offset + sizeof head);
    if (checksum_of_piece(head.before, bytes) != head.checksum) {
      throw Error(ErrorCode::corruption,
                  "a temporary file of the stream is not what was written: the disk, or another "
                  "program, damaged it",
                  folder_);
    }
    piece = head.before;
  }
}

}  // namespace ptin
