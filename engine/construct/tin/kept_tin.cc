// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sorted triangles of a TIN that outlive the process.
#include <array>

#include "engine/construct/grid/frame_file.h"
#include "engine/construct/grid/warnings_file.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tin/tin_source.h"

namespace ptin {

/// The plain values of a TIN on disk.
struct TinTriangles::Kept {
  TinCounts counts;
  std::array<std::uint64_t, 3> records;  ///< Surface, voids, places.
  std::uint64_t codes_are_whole;
};

namespace {

/// Opens a file that another process kept, with the checksums that its index has next.
template <class Record>
std::unique_ptr<RecordFile<Record>> taken_up(FileLayer& files, const std::string& path,
                                             std::uint64_t records, ArrayFileReader& index) {
  auto file = std::make_unique<RecordFile<Record>>(files, path, ScratchFile::Kept::kExisting);
  file->take_up(path, records, index.take_copy<std::uint64_t>());
  return file;
}

}  // namespace

std::array<std::string, 3> TinTriangles::kept_files(const std::string& stem) {
  return {stem + ".surface", stem + ".voids", stem + ".places"};
}

ArrayFileFacts TinTriangles::save(FileLayer& files, const std::string& index) {
  surface_->sync();
  voids_->sync();
  places_->sync();
  const Kept kept{
      counts_, {surface_->size(), voids_->size(), places_->size()}, codes_are_whole_ ? 1U : 0U};
  ArrayFileWriter file(files, index);
  file.put(std::span(&kept, 1));
  put_frame(file, frame_);
  put_warnings(file, warnings_);
  file.put(hull_.corners());
  for (const std::vector<std::uint64_t>* checksums :
       {&surface_->checksums(), &voids_->checksums(), &places_->checksums()}) {
    file.put(*checksums);
  }
  file.sync();
  return file.finish();
}

TinTriangles TinTriangles::load(FileLayer& files, const std::string& kept_as,
                                const std::string& index, const ArrayFileFacts& facts) {
  ArrayFileReader file(index, facts);
  const Kept kept = file.take<Kept>()[0];
  TinTriangles tin;
  tin.counts_ = kept.counts;
  tin.codes_are_whole_ = kept.codes_are_whole != 0;
  tin.frame_ = take_frame(file);
  tin.warnings_ = take_warnings(file);
  tin.hull_ = ConvexHull(file.take_copy<GridPoint>());
  const std::array<std::string, 3> names = kept_files(kept_as);
  tin.surface_ = taken_up<GridTriangle>(files, names[0], kept.records[0], file);
  tin.voids_ = taken_up<GridTriangle>(files, names[1], kept.records[1], file);
  tin.places_ = taken_up<std::uint64_t>(files, names[2], kept.records[2], file);
  return tin;
}

}  // namespace ptin
