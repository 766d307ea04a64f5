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
#include "storage/index_nodes.h"
#include "storage/packed_rtree.h"
#include "storage/page_stores.h"
#include "storage/point_directory.h"
#include "storage/record_page.h"
#include "storage/store_front.h"

namespace ptin {

namespace {

class StoreFileImpl final : public StoreFile {
 public:
  StoreFileImpl(std::unique_ptr<ReadOnlyFile> file, PageAccess access);
  explicit StoreFileImpl(std::unique_ptr<RangedFile> file);

  [[nodiscard]] const std::string& path() const noexcept override { return file_->path(); }
  [[nodiscard]] const StoreFacts& facts() const noexcept override { return front_.facts; }
  [[nodiscard]] std::string_view metadata_json() const noexcept override { return front_.metadata; }
  [[nodiscard]] const CoarsestTin& t0() const noexcept override { return front_.t0; }
  [[nodiscard]] std::uint64_t record_count() const noexcept override {
    return front_.header.record_count;
  }
  [[nodiscard]] std::uint16_t max_rank() const noexcept override {
    return static_cast<std::uint16_t>(front_.header.max_rank);
  }
  [[nodiscard]] std::span<const ErrorBin> error_bins() const noexcept override {
    return front_.bins;
  }
  [[nodiscard]] std::vector<SectionInfo> sections() const override;
  [[nodiscard]] std::uint64_t file_bytes() const noexcept override { return file_->bytes(); }
  [[nodiscard]] std::optional<IoCounters> remote_cost() const noexcept override {
    return far_ != nullptr ? std::optional(far_->cost()) : std::nullopt;
  }
  [[nodiscard]] std::uint64_t fingerprint() const noexcept override {
    return front_.header.header_checksum;
  }
  [[nodiscard]] const RecordIndex& index() const noexcept override { return *index_; }
  [[nodiscard]] const PackedRTree& star_index() const noexcept override { return *index_; }
  [[nodiscard]] const PageStore& pages() const noexcept override { return *pages_; }
  [[nodiscard]] const PointDirectory* directory() const noexcept override {
    return directory_.get();
  }
  [[nodiscard]] PageInfo page_info(PageId id) const override;
  void look_at(PageId id, const Look& look, IoCounters& counters) const override;
  void look_at(const DirectoryPage& page, const Look& look, IoCounters& counters) const override;
  void announce(std::span<const DirectoryPage> pages, IoCounters& counters) const noexcept override;

 private:
  [[nodiscard]] layout::NodeEntry descriptor_of(const DirectoryPage& named,
                                                std::span<const std::byte> bytes) const;

  [[nodiscard]] IndexNodes::Root root() const {
    return {front_.index, front_.index_offset, front_.root_checksum};
  }
  void read_by_copies();
  void search_by_nodes();

  std::unique_ptr<ReadableFile> file_;
  RangedFile* far_ = nullptr;  ///< `file_`, where it lies elsewhere.
  StoreFront front_;
  std::optional<MappedFile> mapping_;
  std::unique_ptr<IndexNodes> nodes_;
  std::unique_ptr<DescribedPageStore> pages_;
  std::unique_ptr<PackedRTree> index_;
  std::unique_ptr<PointDirectory> directory_;
};

/// Reads the front of a file. Reads of a store jump about: the read-ahead of the kernel would read
/// several times what is wanted, of the front and of the nodes behind it.
StoreFront opened_front(const ReadOnlyFile& file) {
  constexpr std::uint64_t kFrontBytes = std::uint64_t{16} << 10;  // of most files, and more
  file.expect_jumps();
  const ByteRange front{0, std::min(kFrontBytes, file.bytes())};
  file.will_need(std::span(&front, 1));
  return read_front(file);
}

StoreFileImpl::StoreFileImpl(std::unique_ptr<ReadOnlyFile> file, PageAccess access)
    : front_(opened_front(*file)) {
  const ReadOnlyFile& opened = *file;
  file_ = std::move(file);
  if (access == PageAccess::kMapped) {
    mapping_.emplace(opened);
    nodes_ = std::make_unique<MappedIndexNodes>(opened, *mapping_, root(), front_.facts.heights);
    pages_ = std::make_unique<MappedPageStore>(opened, *mapping_, front_.slots, *nodes_);
  } else {
    read_by_copies();
  }
  search_by_nodes();
}

StoreFileImpl::StoreFileImpl(std::unique_ptr<RangedFile> file)
    : far_(file.get()), front_(read_front(*file)) {
  file_ = std::move(file);
  far_->keep_on_disk(front_.header.header_checksum);
  read_by_copies();
  search_by_nodes();
  if (front_.directory) {
    directory_ = std::make_unique<PointDirectory>(*file_, *front_.directory, front_.facts.bounds,
                                                  front_.header.page_count);
  }
}

void StoreFileImpl::read_by_copies() {
  nodes_ = std::make_unique<PreadIndexNodes>(*file_, root(), front_.facts.heights);
  pages_ = std::make_unique<PreadPageStore>(*file_, front_.slots, *nodes_);
}

void StoreFileImpl::search_by_nodes() {
  index_ = std::make_unique<PackedRTree>(*nodes_, front_.facts.heights, pages_.get());
  // A file that changed while its front was read is not the one that was checked.
  pages_->check_unchanged();
}

std::vector<SectionInfo> StoreFileImpl::sections() const {
  std::vector<SectionInfo> result;
  result.push_back({"header", 0, sizeof(layout::FileHeader)});
  result.push_back({"section table", sizeof(layout::FileHeader),
                    front_.sections.size() * sizeof(layout::SectionEntry)});
  for (const layout::SectionEntry& s : front_.sections) {
    result.push_back({name_of(static_cast<layout::SectionKind>(s.kind)), s.offset, s.bytes});
  }
  return result;
}

/// What the directory and the page itself say of it; of heights and deviations they say nothing.
layout::NodeEntry StoreFileImpl::descriptor_of(const DirectoryPage& named,
                                               std::span<const std::byte> bytes) const {
  layout::PageHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  const GridBox& bounds = front_.facts.bounds;
  const HeightInterval none = no_heights(front_.facts.heights.type);
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

StoreFile::PageInfo StoreFileImpl::page_info(PageId id) const {
  const layout::NodeEntry d = nodes_->descriptor(id);
  check_descriptor(file_->path(), id, d, front_.facts.heights, front_.slots.page_bytes);
  nodes_->require_undamaged();
  return {d.records, attributes_of(d, front_.facts.heights), short_value(d.error_min),
          star_attributes_of(d, front_.facts.heights)};
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

void StoreFileImpl::look_at(PageId id, const Look& look, IoCounters& counters) const {
  const layout::NodeEntry d = nodes_->descriptor(id);
  PageBuffer buffer;
  const std::span<const std::byte> bytes =
      pages_->view_described(id, d, buffer.of(front_.slots.page_bytes), counters);
  try {
    look(RecordPage(file_->path(), id, d, front_.facts.heights, bytes));
    pages_->require_undamaged();
  } catch (const Error&) {
    pages_->require_undamaged();  // Lost bytes are the cause, where there are any.
    throw;
  }
}

void StoreFileImpl::look_at(const DirectoryPage& named, const Look& look,
                            IoCounters& counters) const {
  PageBuffer buffer;
  const std::span<std::byte> bytes = buffer.of(front_.slots.page_bytes);
  pages_->read_checked(named.id, named.checksum, bytes, counters);
  look(RecordPage(file_->path(), named.id, descriptor_of(named, bytes), front_.facts.heights,
                  bytes));
}

void StoreFileImpl::announce(std::span<const DirectoryPage> pages,
                             IoCounters& counters) const noexcept {
  RangesToCome ranges(*file_, counters);
  for (const DirectoryPage& page : pages) {
    pages_->add_ranges(std::span(&page.id, 1), ranges);
  }
}

/// Lets `decode` append to `out` what a page holds, or nothing.
template <class Records, class Decode>
void append(const StoreFile& store, PageId id, Records& out, IoCounters& counters,
            const Decode& decode) {
  const std::size_t before = out.size();
  try {
    store.look_at(id, decode, counters);
  } catch (const Error&) {
    out.resize(before);
    throw;
  }
}

}  // namespace

void StoreFile::read_records(PageId id, std::vector<VertexSplit>& out, IoCounters& counters) const {
  append(*this, id, out, counters, [&](const RecordPage& page) { page.decode(out); });
}

void StoreFile::read_starred(PageId id, StarredRecords& out, IoCounters& counters) const {
  append(*this, id, out, counters, [&](const RecordPage& page) { page.decode(out); });
}

std::uint32_t StoreFile::read_matching(PageId id, const AttributePredicate& predicate,
                                       std::vector<VertexSplit>& out, IoCounters& counters) const {
  std::uint32_t examined = 0;
  append(*this, id, out, counters, [&](const RecordPage& page) {
    examined = page.records();
    page.decode_matching(predicate, out);
  });
  return examined;
}

std::shared_ptr<const StoreFile> StoreFile::open(const std::string& path, PageAccess access,
                                                 std::shared_ptr<Announcer> announcer,
                                                 ReplacedFile replaced) {
  return std::make_shared<const StoreFileImpl>(
      std::make_unique<ReadOnlyFile>(path, std::move(announcer), replaced), access);
}

std::shared_ptr<const StoreFile> StoreFile::open(std::shared_ptr<RangeSource> source,
                                                 const RemoteCaches& caches) {
  return std::make_shared<const StoreFileImpl>(
      std::make_unique<RangedFile>(std::move(source), caches));
}

}  // namespace ptin
