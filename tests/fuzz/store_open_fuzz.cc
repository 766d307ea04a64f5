// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a store: opened both ways and as one elsewhere, searched, read and verified. Nothing may escape but an
// Error. The first byte says whether checksums are computed again: with them, changes reach what
// lies behind.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "engine/error.h"
#include "engine/query/living/living_page.h"
#include "storage/floor.h"
#include "storage/point_directory.h"
#include "storage/sample_heights.h"
#include "storage/store_file.h"
#include "storage/verify.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/storage/noting_source.h"
#include "tests/storage/seal.h"

namespace {

using namespace ptin;

class LargeErrors final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return a.error > 1.0 && a.roi.max_x > 100;
  }
};

/// The heights of a raster.
void use_floor(const StoreFile& store) {
  const Floor* const floor = store.floor();
  if (floor == nullptr) {
    return;
  }
  IoCounters counters;
  SampleHeights samples;
  Floor::Recent recent;
  floor->visit([](const Floor::Bounds&) { return true; },
               [](const Floor::TileAt&, const FloorTile&) { return true; }, recent, counters);
}

void use(const std::string& path, PageAccess access) {
  const auto store = StoreFile::open(path, access);
  IoCounters counters;
  SampleHeights samples;
  std::vector<PageId> pages;
  std::vector<VertexSplit> records;
  try {
    store->index().search(LargeErrors(), pages, counters);
  } catch (const Error&) {
  }
  store->pages().announce(pages, counters);
  try {
    use_floor(*store);
  } catch (const Error&) {
  }
  for (std::uint64_t i = 0; i < store->pages().page_count() && i < 200; ++i) {
    try {
      records.clear();
      store->read_records(PageId{i}, records, samples, counters);
      StarredRecords starred;
      store->read_starred(PageId{i}, starred, samples, counters);
      if (starred.splits != records) {
        std::abort();
      }
      store->read_matching(PageId{i}, LargeErrors(), records, samples, counters);
    } catch (const Error&) {
    }
  }
}

/// As a file that lies elsewhere: by its directory.
void use_far(const ptin::test::Bytes& file) {
  const auto front = std::min<std::size_t>(file.size(), 4096);
  const auto store = StoreFile::open(std::make_shared<ptin::test::NotingSource>(file, front));
  if (store->directory() == nullptr) {
    return;
  }
  const GridBox& b = store->facts().bounds;
  const std::vector<GridBox> places{{b.min_x, b.min_y, b.min_x, b.min_y},
                                    {b.max_x, b.max_y, b.max_x, b.max_y},
                                    {b.min_x, b.max_y, b.min_x, b.max_y}};
  std::vector<std::vector<DirectoryPage>> found(places.size());
  IoCounters counters;
  SampleHeights samples;
  store->directory()->find(places, {}, found, counters);
  for (const std::vector<DirectoryPage>& pages : found) {
    store->announce(pages, counters);
    for (const DirectoryPage& page : pages) {
      LivingStars living;
      StarredRecords stars;
      const auto look = [&](const RecordPage& p) {
        take_living(p, {}, living);
        p.decode(stars);
      };
      store->look_at(page, look, samples, counters);
    }
  }
}

}  // namespace

PTIN_FUZZ_TARGET(store_open, data, size) {
  if (size == 0) {
    return 0;
  }
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  ptin::test::Bytes file(bytes + 1, bytes + size);
  if (data[0] % 2 == 1) {
    ptin::test::seal(file);
  }
  const int fd = ::memfd_create("store", MFD_CLOEXEC);
  if (fd < 0 || ::write(fd, file.data(), file.size()) != static_cast<ssize_t>(file.size())) {
    return 0;
  }
  const std::string path = "/proc/self/fd/" + std::to_string(fd);
  for (const ptin::PageAccess access : {ptin::PageAccess::kMapped, ptin::PageAccess::kPread}) {
    try {
      use(path, access);
    } catch (const ptin::Error&) {
    }
  }
  try {
    use_far(file);
  } catch (const ptin::Error&) {
  }
  try {
    ptin::VerifyOptions options;
    options.memory_bytes = 1 << 20;
    static_cast<void>(ptin::verify_store(path, options));
  } catch (const ptin::Error&) {
  }
  ::close(fd);
  return 0;
}
