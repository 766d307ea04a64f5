// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/read_way.h"

#include "storage/file/announcer.h"
#include "tools/measure/uring_announcer.h"

namespace ptin::tools {

namespace {

class SilentAnnouncer final : public Announcer {
 public:
  void announce(int, std::uint64_t, std::uint64_t) noexcept override {}
};

}  // namespace

const char* name_of(ReadWay way) noexcept {
  switch (way) {
    case ReadWay::kAnnounced:
      return "announced";
    case ReadWay::kFaults:
      return "faults";
    case ReadWay::kPread:
      return "pread";
    case ReadWay::kUring:
      break;
  }
  return "io_uring";
}

Terrain TerrainOpener::open(const std::string& path, ReadWay way) {
  switch (way) {
    case ReadWay::kAnnounced:
      break;
    case ReadWay::kFaults:
      return Terrain(
          StoreFile::open(path, PageAccess::kMapped, std::make_shared<SilentAnnouncer>()));
    case ReadWay::kPread:
      return Terrain(StoreFile::open(path, PageAccess::kPread));
    case ReadWay::kUring:
      if (!uring_) uring_ = std::make_shared<UringAnnouncer>();
      return Terrain(StoreFile::open(path, PageAccess::kMapped, uring_));
  }
  return Terrain(StoreFile::open(path));
}

}  // namespace ptin::tools
