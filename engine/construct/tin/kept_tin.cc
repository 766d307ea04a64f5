// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sorted triangles of a TIN that outlive the process.
#include <array>

#include "engine/construct/grid/frame_file.h"
#include "engine/construct/grid/warnings_file.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tin/tin_source.h"

namespace ptin {

namespace {

/// Opens a file that another process kept, of which its index tells the size and the checksums next.
template <class Record>
std::unique_ptr<RecordFile<Record>> taken_up(FileLayer& files, const std::string& path,
                                             ArrayFileReader& index) {
  std::uint64_t records = 0;
  std::vector<std::uint64_t> checksums;
  index.values(records, checksums);
  auto file = std::make_unique<RecordFile<Record>>(files, path, ScratchFile::Kept::kExisting);
  file->take_up(path, records, std::move(checksums));
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
  ArrayFileWriter file(files, index);
  file.values(counts_, codes_are_whole_, frame_, warnings_, hull_.corners());
  file.values(surface_->size(), surface_->checksums(), voids_->size(), voids_->checksums(),
              places_->size(), places_->checksums());
  file.sync();
  return file.finish();
}

TinTriangles TinTriangles::load(FileLayer& files, const std::string& kept_as,
                                const std::string& index, const ArrayFileFacts& facts) {
  ArrayFileReader file(index, facts);
  TinTriangles tin;
  std::vector<GridPoint> hull;
  file.values(tin.counts_, tin.codes_are_whole_, tin.frame_, tin.warnings_, hull);
  tin.hull_ = ConvexHull(std::move(hull));
  const std::array<std::string, 3> names = kept_files(kept_as);
  tin.surface_ = taken_up<GridTriangle>(files, names[0], file);
  tin.voids_ = taken_up<GridTriangle>(files, names[1], file);
  tin.places_ = taken_up<std::uint64_t>(files, names[2], file);
  return tin;
}

}  // namespace ptin
