// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/store_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "engine/error.h"
#include "storage/descriptor.h"
#include "storage/file/mapped_file.h"
#include "storage/file/ranged_file.h"
#include "storage/floor.h"
#include "storage/index_nodes.h"
#include "storage/packed_rtree.h"
#include "storage/page_stores.h"
#include "storage/point_directory.h"
#include "storage/record_page.h"
#include "storage/sample_heights.h"
#include "storage/store_front.h"

namespace ptin {

namespace {

/// Reads the front of a file. Reads of a store jump about: the read-ahead of the kernel would read
/// several times what is wanted, of the front and of the nodes behind it.
StoreFront opened_front(const ReadOnlyFile& file) {
  constexpr std::uint64_t kFrontBytes = std::uint64_t{16} << 10;  // of most files, and more
  file.expect_jumps();
  const ByteRange front{0, std::min(kFrontBytes, file.bytes())};
  file.will_need(std::span(&front, 1));
  return read_front(file);
}

IndexNodes::Root root_of(const StoreFront& front) {
  return {front.index, front.index_offset, front.root_checksum};
}

/// What the directory and the page itself say of it; of heights and deviations they say nothing.
layout::NodeEntry descriptor_of(const StoreFront& front, const DirectoryPage& named,
                                std::span<const std::byte> bytes) {
  layout::PageHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  const GridBox& bounds = front.facts.bounds;
  const HeightInterval none = no_heights(front.facts.heights.type);
  layout::NodeEntry d{};
  d.min_x = d.star_min_x = bounds.min_x;
  d.min_y = d.star_min_y = bounds.min_y;
  d.max_x = d.star_max_x = bounds.max_x;
  d.max_y = d.star_max_y = bounds.max_y;
  d.height_lo = d.star_height_lo = none.hi;
  d.height_hi = d.star_height_hi = none.lo;
  d.error_max = named.error_max;
  d.deviation_max = kShortInfinity;
  d.death_min = named.death_min;
  d.records = header.records;
  return d;
}

/// Room for one page of any size, on the stack, untouched until it is used.
class PageBuffer {
 public:
  PageBuffer() {}  // NOLINT: not zeroed on purpose
  [[nodiscard]] std::span<std::byte> of(std::uint32_t page_bytes) noexcept {
    return {bytes_.data(), page_bytes};
  }

 private:
  alignas(64) std::array<std::byte, layout::kMaxPageBytes> bytes_;
};

/// Lets `decode` append to `out` what a page holds, or nothing.
template <class Records, class Decode>
void append(const StoreFile& store, PageId id, Records& out, SampleHeights& heights,
            IoCounters& counters, const Decode& decode) {
  const std::size_t before = out.size();
  try {
    store.look_at(id, decode, heights, counters);
  } catch (const Error&) {
    out.resize(before);
    throw;
  }
}

template <class Record>
std::uint32_t append_matching(const StoreFile& store, PageId id,
                              const AttributePredicate& predicate, std::vector<Record>& out,
                              SampleHeights& heights, IoCounters& counters) {
  std::uint32_t examined = 0;
  append(store, id, out, heights, counters, [&](const RecordPage& page) {
    examined = page.records();
    page.decode_matching(predicate, out);
  });
  return examined;
}

}  // namespace

StoreFile::StoreFile(std::unique_ptr<ReadOnlyFile> file, PageAccess access)
    : front_(std::make_unique<const StoreFront>(opened_front(*file))) {
  const ReadOnlyFile& opened = *file;
  file_ = std::move(file);
  if (access == PageAccess::kMapped) {
    mapping_ = std::make_unique<MappedFile>(opened);
    nodes_ = std::make_unique<MappedIndexNodes>(opened, *mapping_, root_of(*front_),
                                                front_->facts.heights);
    pages_ = std::make_unique<MappedPageStore>(opened, *mapping_, front_->slots, *nodes_);
  } else {
    read_by_copies();
  }
  search_by_nodes();
}

StoreFile::StoreFile(std::unique_ptr<RangedFile> file)
    : front_(std::make_unique<const StoreFront>(read_front(*file))), far_(file.get()) {
  file_ = std::move(file);
  far_->keep_on_disk(front_->header.header_checksum);
  read_by_copies();
  search_by_nodes();
  if (front_->directory) {
    directory_ =
        std::make_unique<PointDirectory>(*file_, *front_->directory, front_->facts.bounds,
                                         PageNames(front_->index, !front_->form.is_plain()));
  }
}

void StoreFile::read_by_copies() {
  nodes_ = std::make_unique<PreadIndexNodes>(*file_, root_of(*front_), front_->facts.heights);
  pages_ = std::make_unique<PreadPageStore>(*file_, front_->slots, *nodes_);
}

void StoreFile::search_by_nodes() {
  index_ = std::make_unique<PackedRTree>(*nodes_, front_->facts.heights, pages_.get());
  // A file that changed while its front was read is not the one that was checked.
  pages_->check_unchanged();
}

std::vector<SectionInfo> StoreFile::sections() const {
  std::vector<SectionInfo> result;
  result.push_back({"header", 0, sizeof(layout::FileHeader)});
  result.push_back({"section table", sizeof(layout::FileHeader),
                    front_->sections.size() * sizeof(layout::SectionEntry)});
  for (const layout::SectionEntry& s : front_->sections) {
    result.push_back({name_of(static_cast<layout::SectionKind>(s.kind)), s.offset, s.bytes});
  }
  return result;
}

StoreFile::~StoreFile() { delete floor_.load(); }

const std::string& StoreFile::path() const noexcept { return file_->path(); }
const StoreFacts& StoreFile::facts() const noexcept { return front_->facts; }
std::string_view StoreFile::metadata_json() const noexcept { return front_->metadata; }
const CoarsestTin& StoreFile::t0() const noexcept { return front_->t0; }
std::uint64_t StoreFile::record_count() const noexcept { return front_->header.record_count; }
std::uint16_t StoreFile::max_rank() const noexcept {
  return static_cast<std::uint16_t>(front_->header.max_rank);
}
std::span<const ErrorBin> StoreFile::error_bins() const noexcept { return front_->bins; }
std::uint64_t StoreFile::file_bytes() const noexcept { return file_->bytes(); }
std::optional<IoCounters> StoreFile::remote_cost() const noexcept {
  return far_ != nullptr ? std::optional(far_->cost()) : std::nullopt;
}
std::uint64_t StoreFile::fingerprint() const noexcept { return front_->header.header_checksum; }
const RecordIndex& StoreFile::index() const noexcept { return *index_; }
const PackedRTree& StoreFile::star_index() const noexcept { return *index_; }
const IndexShape& StoreFile::index_shape() const noexcept { return front_->index; }
const PageStore& StoreFile::pages() const noexcept { return *pages_; }
const PointDirectory* StoreFile::directory() const noexcept { return directory_.get(); }
const Floor* StoreFile::floor() const {
  if (!front_->floor) {
    return nullptr;
  }
  // Threads that come at once may each read the root, and the first one's stays: so one that finds it damaged throws, and
  // keeps nobody waiting.
  const Floor* floor = floor_.load(std::memory_order_acquire);
  if (floor == nullptr) {
    auto made = std::make_unique<const Floor>(*file_, *front_->floor, front_->facts);
    if (floor_.compare_exchange_strong(floor, made.get(), std::memory_order_acq_rel)) {
      floor = made.release();
    }
  }
  return floor;
}

StoreFile::PageInfo StoreFile::page_info(PageId id) const {
  const layout::NodeEntry d = nodes_->descriptor(id);
  check_descriptor(file_->path(), id, d, front_->facts.heights, front_->slots.page_bytes);
  nodes_->require_undamaged();
  return {d.records, attributes_of(d, front_->facts.heights), short_value(d.error_min),
          star_attributes_of(d, front_->facts.heights)};
}

/// The heights of local pages' vertices; null where the file has none.
SampleHeights* StoreFile::used(SampleHeights& heights, IoCounters& counters) const {
  const Floor* const floor = front_->form.is_plain() ? nullptr : this->floor();
  if (floor == nullptr) {
    return nullptr;
  }
  heights.use(*floor, counters);
  return &heights;
}

void StoreFile::look_at(PageId id, const Look& look, SampleHeights& heights,
                        IoCounters& counters) const {
  const layout::NodeEntry d = nodes_->descriptor(id);
  PageBuffer buffer;
  const std::span<const std::byte> bytes =
      pages_->view_described(id, d, buffer.of(front_->slots.page_bytes), counters);
  try {
    look(RecordPage(file_->path(), id, d, front_->facts.heights, front_->form, bytes,
                    used(heights, counters)));
    pages_->require_undamaged();
  } catch (const Error&) {
    pages_->require_undamaged();  // Lost bytes are the cause, where there are any.
    throw;
  }
}

void StoreFile::look_at(const DirectoryPage& named, const Look& look, SampleHeights& heights,
                        IoCounters& counters) const {
  PageBuffer buffer;
  const std::span<std::byte> bytes = buffer.of(front_->slots.page_bytes);
  pages_->read_checked(named.id, named.checksum, bytes, counters);
  look(RecordPage(file_->path(), named.id, descriptor_of(*front_, named, bytes),
                  front_->facts.heights, front_->form, bytes, used(heights, counters)));
}

void StoreFile::announce(std::span<const PageId> ids, SampleHeights& heights,
                         IoCounters& counters) const {
  pages_->announce(ids, counters);
  std::vector<GridBox> boxes;
  // Near tiles are not announced: most of them are in memory.
  for (const PageId id : pages_->is_far() ? ids : std::span<const PageId>()) {
    const layout::NodeEntry d = nodes_->descriptor(id);
    boxes.push_back({d.star_min_x, d.star_min_y, d.star_max_x, d.star_max_y});
  }
  announce_heights(boxes, heights, counters);
}

void StoreFile::announce(std::span<const DirectoryPage> pages,
                         IoCounters& counters) const noexcept {
  RangesToCome ranges(*file_, counters);
  for (const DirectoryPage& page : pages) {
    pages_->add_ranges(std::span(&page.id, 1), ranges);
  }
}

void StoreFile::announce_heights(std::span<const GridBox> stars, SampleHeights& heights,
                                 IoCounters& counters) const {
  if (!pages_->is_far() || used(heights, counters) == nullptr) return;
  std::vector<GridBox> local;
  std::ranges::copy_if(stars, std::back_inserter(local), is_local_box);
  heights.announce(local);
}

void StoreFile::announce_heights_around(std::span<const GridBox> places, SampleHeights& heights,
                                        IoCounters& counters) const {
  if (!pages_->is_far() || used(heights, counters) == nullptr) return;
  // Stars of local pages, which reach over nine tiles at most, hardly ever have longer sides. Those that
  // have cost a round more.
  constexpr std::int32_t kReach = 32;
  // Pages of larger places tell which of many tiles are wanted.
  constexpr std::int64_t kLargest = 128;
  const auto is_large = [](const GridBox& b) {
    return std::int64_t{b.max_x} - b.min_x > kLargest || std::int64_t{b.max_y} - b.min_y > kLargest;
  };
  std::vector<GridBox> around;
  for (const GridBox& place : places) {
    if (is_large(place)) continue;
    around.push_back({std::max(place.min_x, kReach) - kReach,
                      std::max(place.min_y, kReach) - kReach,
                      std::min(place.max_x, kGridMax - kReach) + kReach,
                      std::min(place.max_y, kGridMax - kReach) + kReach});
  }
  heights.announce_known(around);
}

void StoreFile::read_records(PageId id, std::vector<VertexSplit>& out, SampleHeights& heights,
                             IoCounters& counters) const {
  append(*this, id, out, heights, counters, [&](const RecordPage& page) { page.decode(out); });
}

void StoreFile::read_starred(PageId id, StarredRecords& out, SampleHeights& heights,
                             IoCounters& counters) const {
  append(*this, id, out, heights, counters, [&](const RecordPage& page) { page.decode(out); });
}

std::uint32_t StoreFile::read_matching(PageId id, const AttributePredicate& predicate,
                                       std::vector<VertexSplit>& out, SampleHeights& heights,
                                       IoCounters& counters) const {
  return append_matching(*this, id, predicate, out, heights, counters);
}

std::uint32_t StoreFile::read_matching(PageId id, const AttributePredicate& predicate,
                                       std::vector<PendingSplit>& out, SampleHeights& heights,
                                       IoCounters& counters) const {
  return append_matching(*this, id, predicate, out, heights, counters);
}

std::shared_ptr<const StoreFile> StoreFile::open(const std::string& path, PageAccess access,
                                                 std::shared_ptr<Announcer> announcer,
                                                 ReplacedFile replaced) {
  return std::shared_ptr<const StoreFile>(
      new StoreFile(std::make_unique<ReadOnlyFile>(path, std::move(announcer), replaced), access));
}

std::shared_ptr<const StoreFile> StoreFile::open(std::shared_ptr<RangeSource> source,
                                                 const RemoteCaches& caches) {
  return std::shared_ptr<const StoreFile>(
      new StoreFile(std::make_unique<RangedFile>(std::move(source), caches)));
}

}  // namespace ptin
