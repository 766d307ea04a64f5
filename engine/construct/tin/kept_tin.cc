// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sorted triangles of a TIN that outlive the process.
#include <array>
#include <type_traits>

#include "engine/construct/grid/frame_file.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/error.h"

namespace ptin {

/// The plain values of a TIN on disk.
struct TinTriangles::Kept {
  TinCounts counts;
  std::array<std::uint64_t, 3> records;    ///< Surface, voids, places.
  std::array<std::uint64_t, 3> checksums;  ///< Likewise.
  std::uint64_t codes_are_whole;
};

namespace {

/// Opens a file that an earlier process kept, and reads all of it to check it.
template <class Record>
std::unique_ptr<RecordFile<Record>> checked(FileLayer& files, const std::string& path,
                                            std::uint64_t records, std::uint64_t checksum,
                                            const std::stop_token& stop) {
  auto file = std::make_unique<RecordFile<Record>>(files, path, ScratchFile::Kept::kExisting);
  if (!file->take_up(path, records, checksum, stop)) {
    throw Error(ErrorCode::corruption,
                "the sorted triangles of the unfinished build are damaged; start again after "
                "--discard",
                path);
  }
  return file;
}

}  // namespace

std::array<std::string, 3> TinTriangles::kept_files(const std::string& stem) {
  return {stem + ".surface", stem + ".voids", stem + ".places"};
}

ArrayFileFacts TinTriangles::save(FileLayer& files, const std::string& index) {
  static_assert(std::is_trivially_copyable_v<Kept>);
  surface_->sync();
  voids_->sync();
  places_->sync();
  const Kept kept{counts_,
                  {surface_->size(), voids_->size(), places_->size()},
                  {surface_->checksum(), voids_->checksum(), places_->checksum()},
                  codes_are_whole_ ? 1U : 0U};
  ArrayFileWriter file(files, index);
  file.put(std::span(&kept, 1));
  put_frame(file, frame_);
  file.put(hull_.corners());
  file.sync();
  return file.facts();
}

TinTriangles TinTriangles::load(FileLayer& files, const std::string& kept_as,
                                const std::string& index, const ArrayFileFacts& facts,
                                const std::stop_token& stop,
                                const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  ArrayFileReader file(index, facts);
  const Kept kept = file.take<Kept>()[0];
  TinTriangles tin;
  tin.counts_ = kept.counts;
  tin.codes_are_whole_ = kept.codes_are_whole != 0;
  tin.frame_ = take_frame(file);
  tin.hull_ = ConvexHull(file.take_copy<GridPoint>());
  file.require_undamaged();
  const std::array<std::string, 3> names = kept_files(kept_as);
  const auto report = [&](std::uint64_t done) {
    if (progress) {
      progress(done, names.size());
    }
  };
  report(0);
  tin.surface_ = checked<GridTriangle>(files, names[0], kept.records[0], kept.checksums[0], stop);
  report(1);
  tin.voids_ = checked<GridTriangle>(files, names[1], kept.records[1], kept.checksums[1], stop);
  report(2);
  tin.places_ = checked<std::uint64_t>(files, names[2], kept.records[2], kept.checksums[2], stop);
  report(3);
  return tin;
}

}  // namespace ptin
