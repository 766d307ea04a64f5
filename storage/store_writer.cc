// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/store_writer.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <vector>

#include <sys/stat.h>

#include "engine/check.h"
#include "engine/error.h"
#include "storage/descriptor.h"
#include "storage/directory_writer.h"
#include "storage/facts.h"
#include "storage/file/checksum.h"
#include "storage/file/file_questions.h"
#include "storage/layout.h"
#include "storage/page_columns.h"
#include "storage/short_float.h"
#include "storage/store_front.h"

namespace ptin {

namespace {

/// The mark that the journal of an unfinished build writes to NodeEntry::reserved of the last page of a segment.
constexpr std::uint32_t kEndsSegment = 1;

constexpr std::uint64_t padded_to(std::uint64_t bytes, std::uint64_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

void check_target(const std::string& path, const StoreWriterOptions& options) {
  if (!std::has_single_bit(options.page_bytes) || options.page_bytes < layout::kMinPageBytes ||
      options.page_bytes > layout::kMaxPageBytes) {
    refuse("page_bytes must be a power of two from 4096 to 65536", path);
  }
  struct stat target {};
  if (::stat(path.c_str(), &target) != 0) {
    if (errno != ENOENT) {
      throw system_error(errno, "cannot look at the output file", path);
    }
    return;
  }
  if (!S_ISREG(target.st_mode)) {
    refuse("the output exists and is no regular file", path);
  }
  if (!options.overwrite) {
    refuse("the file exists; remove it, or ask for overwriting", path);
  }
}

// The sections before the index, laid out one after the other behind header and table.
class Front {
 public:
  explicit Front(std::size_t sections)
      : bytes_(sizeof(layout::FileHeader) + sections * sizeof(layout::SectionEntry)) {}

  void add(layout::SectionKind kind, std::span<const std::byte> content,
           std::uint64_t multiple = 8) {
    bytes_.resize(padded_to(bytes_.size(), multiple));
    table_.push_back(
        {static_cast<std::uint32_t>(kind), 0, bytes_.size(), content.size(), checksum_of(content)});
    bytes_.insert(bytes_.end(), content.begin(), content.end());
  }
  // Room for a section, of which the content comes later.
  void reserve(layout::SectionKind kind, std::uint64_t bytes) {
    add(kind, std::vector<std::byte>(bytes));
  }
  void fill(layout::SectionKind kind, std::span<const std::byte> content) {
    layout::SectionEntry& s = section(kind);
    PTIN_CHECK(s.bytes == content.size());
    std::copy(content.begin(), content.end(),
              bytes_.begin() + static_cast<std::ptrdiff_t>(s.offset));
    s.checksum = checksum_of(content);
  }
  [[nodiscard]] std::uint64_t add_outside(layout::SectionKind kind, std::uint64_t offset,
                                          std::uint64_t bytes) {
    table_.push_back({static_cast<std::uint32_t>(kind), 0, offset, bytes, 0});
    return offset + bytes;
  }
  [[nodiscard]] std::uint64_t size() const { return bytes_.size(); }
  // REQUIRES: it was added.
  [[nodiscard]] layout::SectionEntry& section(layout::SectionKind kind) {
    return *std::find_if(table_.begin(), table_.end(), [&](const layout::SectionEntry& s) {
      return s.kind == static_cast<std::uint32_t>(kind);
    });
  }

  // All bytes up to `end`, with the header and the table in their places.
  std::span<const std::byte> finish(layout::FileHeader& header, std::uint64_t end) {
    header.section_count = static_cast<std::uint32_t>(table_.size());
    header.section_table_checksum = checksum_of(std::as_bytes(std::span(table_)));
    header.header_checksum = checksum_of(
        std::as_bytes(std::span(&header, 1)).first(offsetof(layout::FileHeader, header_checksum)));
    std::memcpy(bytes_.data(), &header, sizeof header);
    std::memcpy(bytes_.data() + sizeof header, table_.data(),
                table_.size() * sizeof(layout::SectionEntry));
    bytes_.resize(end);
    return bytes_;
  }

 private:
  std::vector<std::byte> bytes_;
  std::vector<layout::SectionEntry> table_;
};

std::vector<layout::ErrorBinEntry> stored(const std::vector<ErrorBin>& bins) {
  std::vector<layout::ErrorBinEntry> result;
  for (const ErrorBin& b : bins) {
    result.push_back(
        {layout::to_bits(b.upper), layout::to_bits(b.max_deviation), b.records, b.void_vertices});
  }
  return result;
}

std::vector<layout::T0Vertex> stored(const std::vector<CoarsestTin::V>& vertices, HeightType type) {
  std::vector<layout::T0Vertex> result;
  for (const CoarsestTin::V& v : vertices) {
    // As in pages, -0 is written as 0.
    const HeightBits height = height_of_ordered(ordered_height(v.height, type), type);
    result.push_back({v.position.x, v.position.y, v.has_height != 0 ? height : 0, v.has_height});
  }
  return result;
}

std::vector<layout::T0Triangle> stored(const std::vector<CoarsestTin::T>& triangles) {
  std::vector<layout::T0Triangle> result;
  for (const CoarsestTin::T& t : triangles) {
    result.push_back(
        {{t.v[0], t.v[1], t.v[2]}, static_cast<std::uint16_t>(t.is_void), death_bits(t.death)});
  }
  return result;
}

std::vector<layout::SegmentEntry> stored(const std::vector<std::uint64_t>& segments) {
  std::vector<layout::SegmentEntry> result;
  for (const std::uint64_t pages : segments) {
    result.push_back({static_cast<std::uint16_t>(pages - 1)});
  }
  return result;
}

/// A walk over the same pages, with the names of pages for their numbers. Borrows both.
PageWalk named(const PageWalk& walk, const PageNames& names) {
  return [&](const PageVisitor& visit) {
    walk([&](std::uint64_t page, const layout::NodeEntry& d) { visit(names.of(page), d); });
  };
}

ScratchFile kept_file(FileLayer& files, const std::string& path) {
  return ScratchFile(files, path, ScratchFile::kept_at(path));
}

/// Adds the sections of a raster's heights below the root to the table, from an offset on.
/// @return Where they end.
std::uint64_t place_floor(Front& front, std::uint64_t offset,
                          std::span<const layout::FloorNode> below, std::uint64_t page_bytes,
                          std::uint64_t page_checksum) {
  offset = front.add_outside(layout::SectionKind::kFloorNodes, offset, below.size_bytes());
  offset = front.add_outside(layout::SectionKind::kFloorPages, offset, page_bytes);
  front.section(layout::SectionKind::kFloorNodes).checksum = checksum_of(std::as_bytes(below));
  front.section(layout::SectionKind::kFloorPages).checksum = page_checksum;
  return offset;
}

}  // namespace

StoreWriter::StoreWriter(const std::string& path, const StoreWriterOptions& options)
    : path_(path),
      options_(options),
      files_(options.files != nullptr ? *options.files : FileLayer::system()),
      folder_(folder_of(path)),
      stem_(std::filesystem::path(path).filename().string()),
      file_(options.work_folder.empty() ? ScratchFile(files_, folder_, stem_, false)
                                        : kept_file(files_, pages_file_in(options.work_folder))) {
  if (!options_.work_folder.empty()) {
    const std::string journal = options_.work_folder + "/descriptors";
    journal_.emplace(files_, journal, ScratchFile::kept_at(journal));
  }
}

void StoreWriter::start(const HeightEncoding& heights) {
  if (!heights_) {
    heights_ = heights;
    index_.emplace(files_, folder_, stem_, heights);
  }
  if (!(*heights_ == heights)) {
    refuse("all segments of a file, and its facts, need one height encoding", path_);
  }
}

void StoreWriter::add_segment(const PackedSegment& segment, const HeightEncoding& heights) {
  PTIN_CHECK(!published_ &&
             segment.pages.size() == segment.descriptors.size() * options_.page_bytes);
  for (std::size_t i = 0; i < segment.descriptors.size(); ++i) {
    const auto page =
        std::span(segment.pages).subspan(i * options_.page_bytes, options_.page_bytes);
    PTIN_CHECK(checksum_of(page) == segment.descriptors[i].checksum);
  }
  start(heights);
  file_.write_at(segment.pages, written_bytes_);
  add_placed(segment, heights);
}

void StoreWriter::add_placed(const PackedSegment& segment, const HeightEncoding& heights) {
  std::uint64_t records = 0;
  for (const layout::NodeEntry& entry : segment.descriptors) records += entry.records;
  PTIN_CHECK(!published_ && records == records_in(segment.errors));
  start(heights);
  for (const layout::NodeEntry& entry : segment.descriptors) {
    index_->add(entry);
    if (journal_) {
      layout::NodeEntry kept = entry;
      kept.reserved = &entry == &segment.descriptors.back() ? kEndsSegment : 0;
      journal_->add(kept);
    }
  }
  index_->end_segment();
  count(segment.errors, segment.max_rank);
  written_bytes_ += segment.descriptors.size() * options_.page_bytes;
}

void StoreWriter::count(const std::vector<ErrorBin>& errors, std::uint16_t max_rank) {
  max_rank_ = std::max(max_rank_, max_rank);
  for (const ErrorBin& bin : errors) {
    errors_.add(bin);
  }
}

StoreCheckpoint StoreWriter::position() const {
  PTIN_CHECK(journal_.has_value());
  return {journal_->pages(), journal_->chain(), errors_.bins(), max_rank_};
}

void StoreWriter::sync() {
  PTIN_CHECK(journal_.has_value() && !published_);
  file_.sync();
  journal_->sync();
}

// Where publish() was interrupted, it has put the front of the file over the first pages. Puts
// their copies back.
void StoreWriter::restore_moved_pages() {
  const std::optional<PublishMark> mark = journal_->find_mark();
  if (!mark) {
    return;
  }
  const std::uint64_t pages_bytes = mark->pages * options_.page_bytes;
  if (mark->moved_bytes > pages_bytes || mark->moved_to < pages_bytes) {
    throw Error(ErrorCode::corruption, "the unfinished build's mark of publishing is not sound",
                path_);
  }
  file_.copy_from(file_, mark->moved_to, mark->moved_bytes, 0);
  file_.sync();
}

// Reads the next page again, and checks it.
void StoreWriter::take_back(const layout::NodeEntry& entry, std::vector<std::byte>& page) {
  file_.read_at(page, written_bytes_);
  if (checksum_of(page) != entry.checksum) {
    throw Error(ErrorCode::corruption,
                "page " + std::to_string(written_bytes_ / options_.page_bytes) +
                    " of the unfinished build is damaged",
                path_);
  }
  layout::NodeEntry described = entry;
  described.reserved = 0;
  index_->add(described);
  if (entry.reserved == kEndsSegment) {
    index_->end_segment();
  }
  written_bytes_ += page.size();
}

void StoreWriter::resume(const StoreCheckpoint& checkpoint, const HeightEncoding& heights) {
  PTIN_CHECK(journal_.has_value() && written_bytes_ == 0);
  start(heights);
  restore_moved_pages();
  std::vector<std::byte> page(options_.page_bytes);
  std::uint64_t records = 0;
  journal_->replay(checkpoint.pages, checkpoint.chain, [&](const layout::NodeEntry& entry) {
    take_back(entry, page);
    records += entry.records;
  });
  if (records != records_in(checkpoint.errors)) {
    throw Error(ErrorCode::corruption,
                "the counts of the unfinished build are not those of its pages", path_);
  }
  count(checkpoint.errors, checkpoint.max_rank);
  // The journal is synced before the pages are cut. Otherwise a power cut could bring back a mark
  // of publishing that speaks of copies which were cut off.
  journal_->sync();
  file_.truncate(written_bytes_);
}

// Makes room for the front: copies the pages that are in its way to the end. That moves no more
// bytes than the front has. Returns where the pages lie then.
PageSlots StoreWriter::move_pages_behind(std::uint64_t front_bytes) {
  const std::uint64_t pages_bytes = written_bytes_;
  const std::uint64_t moved = std::min(front_bytes, pages_bytes);
  file_.reserve(pages_bytes, front_bytes);
  file_.copy_from(file_, 0, moved, std::max(front_bytes, pages_bytes));
  if (journal_) {
    file_.sync();  // The mark promises the copies: they come first.
    journal_->mark(moved, std::max(front_bytes, pages_bytes));
  }
  const std::uint64_t pages = pages_bytes / options_.page_bytes;
  const std::uint64_t front_pages = front_bytes / options_.page_bytes;
  return {pages, front_pages < pages ? front_pages : 0, front_bytes, options_.page_bytes};
}

void StoreWriter::add_floor(const FloorFacts& facts,
                            const std::function<bool(FloorWriter&)>& fill) {
  PTIN_CHECK(!published_);
  floor_nodes_.clear();
  floor_bytes_ = 0;
  floor_pages_ = std::make_unique<ScratchFile>(files_, folder_, stem_ + ".heights", true);
  RunningChecksum checksum;
  FloorWriter floor([&](std::span<const std::byte> page) {
    checksum.add(page);
    floor_pages_->write_at(page, floor_bytes_);
    floor_bytes_ += page.size();
  });
  if (!fill(floor)) {
    floor_pages_.reset();
    return;
  }
  floor.finish();
  floor_checksum_ = checksum.value();
  floor_nodes_ = floor.nodes(facts);
}

/// Writes the heights and the nodes below their root behind the pages of records.
void StoreWriter::write_floor(std::uint64_t nodes_offset) {
  const auto nodes = std::as_bytes(std::span(floor_nodes_).subspan(1));
  file_.write_at(nodes, nodes_offset);
  file_.copy_from(*floor_pages_, 0, floor_bytes_, nodes_offset + nodes.size());
}

void StoreWriter::publish(const StoreFacts& facts, const CoarsestTin& t0,
                          const std::string& metadata_json) {
  PTIN_CHECK(!published_);
  if (const char* fault = fault_in(facts)) {
    refuse(fault, path_);
  }
  if (const char* fault = fault_in(t0, facts)) {
    refuse(fault, path_);
  }
  start(facts.heights);
  index_->finish();
  const IndexShape shape(index_->segments());
  const PageNames names(shape, true);
  const PageWalk walk = [&](const PageVisitor& visit) { index_->walk(visit); };
  std::optional<DirectoryWriter> directory;
  if (index_->pages() >= options_.directory.least_pages && names.are_known()) {
    directory = DirectoryWriter::plan(facts.bounds, index_->pages(), options_.page_bytes,
                                      options_.directory, walk);
  }
  const bool has_floor = !floor_nodes_.empty();
  Front front(7 + (directory ? 2 : 0) + (has_floor ? 3 : 0));
  const std::vector<layout::T0Vertex> vertices = stored(t0.vertices, facts.heights.type);
  const std::vector<layout::T0Triangle> triangles = stored(t0.triangles);
  const std::vector<layout::ErrorBinEntry> bins = stored(errors_.bins());
  const std::vector<layout::SegmentEntry> segments = stored(index_->segments());
  // The index is found with them, so a far file wants them first.
  front.add(layout::SectionKind::kSegments, std::as_bytes(std::span(segments)));
  front.add(layout::SectionKind::kMetadata, std::as_bytes(std::span(metadata_json)));
  front.add(layout::SectionKind::kT0Vertices, std::as_bytes(std::span(vertices)));
  front.add(layout::SectionKind::kT0Triangles, std::as_bytes(std::span(triangles)));
  front.add(layout::SectionKind::kErrorTable, std::as_bytes(std::span(bins)));
  if (directory) {
    front.reserve(layout::SectionKind::kDirectory, directory->root_bytes());
  }
  if (has_floor) {
    front.add(layout::SectionKind::kFloorRoot, std::as_bytes(std::span(floor_nodes_).first(1)),
              layout::kNodeBytes);
  }
  const std::uint64_t index_offset = padded_to(front.size(), layout::kNodeBytes);
  const std::uint64_t index_end =
      front.add_outside(layout::SectionKind::kIndex, index_offset, shape.total_bytes());
  const std::uint64_t nodes_end = directory
                                      ? front.add_outside(layout::SectionKind::kDirectoryNodes,
                                                          index_end, directory->node_bytes())
                                      : index_end;
  const std::uint64_t front_bytes = padded_to(nodes_end, options_.page_bytes);
  layout::FileHeader header{};
  const std::uint64_t pages_end =
      front.add_outside(layout::SectionKind::kPages, front_bytes, written_bytes_);
  header.file_bytes = has_floor ? place_floor(front, pages_end, std::span(floor_nodes_).subspan(1),
                                              floor_bytes_, floor_checksum_)
                                : pages_end;

  const PageSlots slots = move_pages_behind(front_bytes);
  if (directory) {
    front.section(layout::SectionKind::kDirectoryNodes).checksum =
        directory->write_nodes(named(walk, names), file_, index_end);
    front.fill(layout::SectionKind::kDirectory, directory->root());
  }
  front.section(layout::SectionKind::kIndex).checksum = index_->write_to(file_, index_offset);
  const std::vector<std::byte> gap(front_bytes - nodes_end);
  file_.write_at(gap, nodes_end);
  if (has_floor) write_floor(pages_end);

  header.magic = layout::kMagic;
  header.major_version = layout::kMajorVersion;
  header.minor_version = 0;
  header.header_bytes = sizeof header;
  header.page_bytes = options_.page_bytes;
  header.page_count = slots.pages;
  header.first_page = slots.first_page;
  header.record_count = records_in(errors_.bins());
  header.max_rank = max_rank_;
  put_facts(facts, header);
  file_.write_at(front.finish(header, index_offset), 0);
  published_ = true;
  file_.publish_as(path_, options_.overwrite);
}

std::string pages_file_in(const std::string& work_folder) { return work_folder + "/pages"; }

std::unique_ptr<StoreWriter> StoreWriter::create(const std::string& path,
                                                 const StoreWriterOptions& options) {
  check_target(path, options);
  return std::unique_ptr<StoreWriter>(new StoreWriter(path, options));
}

}  // namespace ptin
