// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/store_front.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "engine/error.h"
#include "storage/error_table.h"
#include "storage/facts.h"
#include "storage/file/checksum.h"
#include "storage/file_beginning.h"
#include "storage/metadata_text.h"
#include "storage/short_float.h"

namespace ptin {

namespace {

using layout::FileHeader;
using layout::SectionEntry;
using layout::SectionKind;

[[noreturn]] void damaged(const std::string& path, const std::string& message) {
  throw Error(ErrorCode::corruption, message, path);
}

void require(bool condition, const std::string& path, const char* message) {
  if (!condition) {
    damaged(path, message);
  }
}

using Magic = std::array<std::uint8_t, layout::kMagic.size()>;

std::ptrdiff_t agreeing_bytes(std::span<const std::byte> first, const Magic& magic) {
  std::ptrdiff_t agree = 0;
  for (std::size_t i = 0; i < std::min(first.size(), magic.size()); ++i) {
    agree += first[i] == std::byte{magic[i]} ? 1 : 0;
  }
  return agree;
}

/// Whether a file that does not begin like a store was one: most of the first bytes are there, or a
/// header is sound but for them, or all are zero, as those of a copy that was not finished.
bool was_store(std::span<const std::byte> first, FileHeader header) {
  const auto bytes = static_cast<std::ptrdiff_t>(std::min(first.size(), layout::kMagic.size()));
  if (2 * agreeing_bytes(first, layout::kMagic) > bytes) return true;
  header.magic = layout::kMagic;
  const auto checked =
      std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_checksum));
  return header.header_checksum == checksum_of(checked) ||
         std::all_of(first.begin(), first.end(), [](std::byte b) { return b == std::byte{0}; });
}

/// Refuses a file that is no store. Where it is another file altogether nothing is damaged: the wrong
/// one was named.
void check_beginning(const ReadableFile& file, const FileHeader& header, std::uint64_t bytes) {
  const auto there = std::as_bytes(std::span(&header, 1)).first(bytes);
  const auto first = there.first(std::min<std::size_t>(there.size(), kBeginningBytes));
  const auto bytes_of_magic = static_cast<std::ptrdiff_t>(layout::kMagic.size());
  if (agreeing_bytes(first, layout::kMagic) == bytes_of_magic) return;
  if (agreeing_bytes(first, layout::kStreamMagic) == bytes_of_magic) {
    refuse("this is a stream, not a store; `ptin unstream` makes a mesh of it", file.path());
  }
  if (!first.empty() && was_store(first, header))
    damaged(file.path(), "the file does not begin like a .ptin file; it is damaged");
  refuse("this is not a .ptin file: " + beginning_of(first), file.path());
}

FileHeader read_header(const ReadableFile& file) {
  const std::string& path = file.path();
  FileHeader h{};
  const auto there = std::min<std::uint64_t>(file.bytes(), sizeof h);
  file.read_at(std::as_writable_bytes(std::span(&h, 1)).first(there), 0);
  check_beginning(file, h, there);
  require(there == sizeof h, path,
          "the file is shorter than the header of a .ptin file; it was cut short");
  if (h.major_version > layout::kMajorVersion) {
    throw Error(ErrorCode::unsupported_version,
                "the file has format version " + std::to_string(h.major_version) + "." +
                    std::to_string(h.minor_version) +
                    ", and this program reads up to major version " +
                    std::to_string(layout::kMajorVersion) + "; take a newer program",
                path);
  }
  if (h.major_version == 1) {
    throw Error(ErrorCode::unsupported_version,
                "the file has format version 1, which was provisional and is read no longer; "
                "build it again from its source with `ptin build`",
                path);
  }
  const auto bytes = std::as_bytes(std::span(&h, 1)).first(offsetof(FileHeader, header_checksum));
  require(h.header_checksum == checksum_of(bytes), path,
          "the header does not match its checksum; the file is damaged");
  return h;
}

/// Whether the file may hold what no version that is known has.
bool is_newer(const FileHeader& h) noexcept {
  return h.minor_version > layout::newest_minor(h.major_version);
}

void check_header(const FileHeader& h, const ReadableFile& file) {
  const std::string& path = file.path();
  require(h.major_version != 0, path, "the header has major version 0, which no program wrote");
  require(h.header_bytes == sizeof h, path, "the header should say that it has 256 bytes");
  if (h.file_bytes != file.bytes()) {
    damaged(path, "the header says " + std::to_string(h.file_bytes) + " bytes, the file has " +
                      std::to_string(file.bytes()) + "; it was cut short or added to");
  }
  require(std::has_single_bit(h.page_bytes) && h.page_bytes >= layout::kMinPageBytes &&
              h.page_bytes <= layout::kMaxPageBytes,
          path, "the page size must be a power of two from 4096 to 65536");
  require(h.section_count <= layout::kMaxSections &&
              sizeof h + h.section_count * sizeof(SectionEntry) <= h.file_bytes,
          path, "the section table does not fit into the file");
  require(h.page_count <= h.file_bytes / h.page_bytes, path,
          "the file is too short for its number of pages");
  require(h.first_page < std::max<std::uint64_t>(h.page_count, 1), path,
          "the first page is none of the pages");
  require(h.record_count >= h.page_count &&
              h.record_count <= h.page_count * (h.page_bytes / layout::kLeastRecordBytes),
          path, "the number of records does not go with the number of pages");
  require(h.max_rank <= UINT16_MAX, path, "the largest rank is above 65535");
  // Reserved bytes of a later minor version may mean something; ours are zero.
  const bool zero =
      std::all_of(h.reserved.begin(), h.reserved.end(), [](std::uint8_t b) { return b == 0; });
  require((zero && (h.flags & ~layout::kFreeOfVoids) == 0) || is_newer(h), path,
          "reserved bytes of the header are not zero");
  const char* fault = fault_in(facts_of(h));
  require(fault == nullptr, path, fault);
}

std::vector<SectionEntry> read_table(const FileHeader& h, const ReadableFile& file) {
  const std::string& path = file.path();
  std::vector<SectionEntry> table(h.section_count);
  file.read_at(std::as_writable_bytes(std::span(table)), sizeof h);
  require(checksum_of(std::as_bytes(std::span(table))) == h.section_table_checksum, path,
          "the section table does not match its checksum; the file is damaged");
  std::uint64_t end = sizeof h + table.size() * sizeof(SectionEntry);
  for (const SectionEntry& s : table) {
    require(s.reserved == 0 || is_newer(h), path, "a reserved field of a section is not 0");
    require(s.offset % 8 == 0 && s.offset >= end && s.offset <= h.file_bytes &&
                s.bytes <= h.file_bytes - s.offset,
            path, "a section lies outside of the file, or sections overlap or do not ascend");
    end = s.offset + s.bytes;
  }
  require(end == h.file_bytes, path, "the file does not end with its last section");
  return table;
}

const SectionEntry* find_any(const std::vector<SectionEntry>& table, SectionKind kind,
                             const std::string& path) {
  const SectionEntry* found = nullptr;
  for (const SectionEntry& s : table) {
    if (s.kind == static_cast<std::uint32_t>(kind)) {
      require(found == nullptr, path, "a section is there twice");
      found = &s;
    }
  }
  return found;
}

const SectionEntry& find(const std::vector<SectionEntry>& table, SectionKind kind,
                         const std::string& path) {
  const SectionEntry* const found = find_any(table, kind, path);
  if (found == nullptr) {
    damaged(path, std::string("the section \"") + name_of(kind) + "\" is missing");
  }
  return *found;
}

// A whole section as an array of T, once its checksum was compared.
template <class T>
std::vector<T> read_section(const std::vector<SectionEntry>& table, SectionKind kind,
                            const ReadableFile& file) {
  const SectionEntry& s = find(table, kind, file.path());
  if (s.bytes % sizeof(T) != 0) {
    damaged(file.path(), std::string("the section \"") + name_of(kind) +
                             "\" is no whole number of entries long");
  }
  std::vector<T> content(s.bytes / sizeof(T));
  file.read_at(std::as_writable_bytes(std::span(content)), s.offset);
  if (checksum_of(std::as_bytes(std::span(content))) != s.checksum) {
    damaged(file.path(), std::string("the section \"") + name_of(kind) +
                             "\" does not match its checksum; the file is damaged");
  }
  return content;
}

CoarsestTin read_t0(const std::vector<SectionEntry>& table, const StoreFacts& facts,
                    const ReadableFile& file) {
  CoarsestTin t0;
  for (const auto& v : read_section<layout::T0Vertex>(table, SectionKind::kT0Vertices, file)) {
    t0.vertices.push_back({{v.x, v.y}, v.height, v.has_height});
  }
  for (const auto& t : read_section<layout::T0Triangle>(table, SectionKind::kT0Triangles, file)) {
    require(t.death <= kMostDeathBits, file.path(),
            "a triangle of T0 dies at an error that is no number");
    const float death = t.death == 0 ? kLivesOn : short_value(static_cast<ShortBits>(t.death - 1));
    t0.triangles.push_back({{t.v[0], t.v[1], t.v[2]}, t.is_void, death});
  }
  const char* fault = fault_in(t0, facts);
  require(fault == nullptr, file.path(), fault);
  return t0;
}

std::vector<ErrorBin> read_bins(const std::vector<SectionEntry>& table, const FileHeader& h,
                                const ReadableFile& file) {
  const std::string& path = file.path();
  std::vector<ErrorBin> bins;
  std::uint64_t records = 0;
  for (const auto& b : read_section<layout::ErrorBinEntry>(table, SectionKind::kErrorTable, file)) {
    require(b.upper <= layout::kInfinityBits && b.max_deviation <= layout::kInfinityBits &&
                layout::to_bits(error_bin_upper(layout::to_float(b.upper))) == b.upper,
            path, "an error of the error table is no bound of a bin");
    require(bins.empty() ? b.upper == 0 : layout::to_float(b.upper) > bins.back().upper, path,
            "the error table does not ascend from 0");
    require(b.void_vertices <= b.records && b.records <= h.record_count - records, path,
            "the error table counts more records than there are");
    records += b.records;
    bins.push_back(
        {layout::to_float(b.upper), layout::to_float(b.max_deviation), b.records, b.void_vertices});
  }
  require(!bins.empty() && records == h.record_count, path,
          "the error table counts fewer records than there are");
  return bins;
}

/// Pages of each segment. A file of format 2 has a single one.
std::vector<std::uint64_t> segments_of(const StoreFront& front, const ReadableFile& file) {
  const FileHeader& h = front.header;
  std::vector<std::uint64_t> segments;
  if (h.major_version == 2) {
    if (h.page_count > 0) segments.push_back(h.page_count);
    return segments;
  }
  std::uint64_t left = h.page_count;
  for (const auto& s :
       read_section<layout::SegmentEntry>(front.sections, SectionKind::kSegments, file)) {
    const std::uint64_t pages = std::uint64_t{s.last} + 1;
    require(pages <= left, file.path(), "the segments have more pages than there are");
    left -= pages;
    segments.push_back(pages);
  }
  require(left == 0, file.path(), "the segments have fewer pages than there are");
  return segments;
}

void place_index_and_pages(StoreFront& front, const ReadableFile& file) {
  const FileHeader& h = front.header;
  const std::string& path = file.path();
  const SectionEntry& index = find(front.sections, SectionKind::kIndex, path);
  const SectionEntry& pages = find(front.sections, SectionKind::kPages, path);
  front.index = IndexShape(segments_of(front, file));
  require(index.bytes == front.index.total_bytes(), path,
          "the index has not the length that the number of pages asks for");
  require(index.offset % layout::kNodeBytes == 0, path,
          "the index does not begin at a multiple of 4096 bytes");
  require(pages.bytes == h.page_count * h.page_bytes, path,
          "the pages have not the length that their number asks for");
  require(pages.offset % h.page_bytes == 0, path,
          "the pages do not begin at a multiple of their size");
  require(pages.checksum == 0, path,
          "the checksum of the page section should be 0: each page has its own");
  front.index_offset = index.offset;
  front.root_checksum = index.checksum;
  front.slots = {h.page_count, h.first_page, pages.offset, h.page_bytes};
}

/// Where the directory lies. Nothing of it is read at the opening.
std::optional<DirectoryPlace> place_of_directory(const StoreFront& front, const std::string& path) {
  const SectionEntry* const root = find_any(front.sections, SectionKind::kDirectory, path);
  const SectionEntry* const nodes = find_any(front.sections, SectionKind::kDirectoryNodes, path);
  require((root == nullptr) == (nodes == nullptr), path,
          "of the directory and its nodes one is missing");
  if (root == nullptr) {
    return std::nullopt;
  }
  constexpr std::uint64_t kMostBytes =
      sizeof(layout::DirectoryHead) +
      std::uint64_t{layout::kMostDirectoryCells} * layout::kDirectoryCellBytes;
  require(root->bytes > sizeof(layout::DirectoryHead) && root->bytes <= kMostBytes, path,
          "the directory has not the length of any number of cells");
  require(nodes->bytes % layout::kDirectoryEntryBytes == 0, path,
          "the nodes of the directory are no whole number of entries long");
  return DirectoryPlace{{root->offset, root->bytes}, {nodes->offset, nodes->bytes}, root->checksum};
}

/// Where the heights of a raster lie. Nothing of them is read at the opening.
std::optional<FloorPlace> place_of_floor(const StoreFront& front, const std::string& path) {
  const SectionEntry* const root = find_any(front.sections, SectionKind::kFloorRoot, path);
  const SectionEntry* const nodes = find_any(front.sections, SectionKind::kFloorNodes, path);
  const SectionEntry* const pages = find_any(front.sections, SectionKind::kFloorPages, path);
  require((root == nullptr) == (nodes == nullptr) && (root == nullptr) == (pages == nullptr), path,
          "of the heights of a raster and the nodes above them one section is missing");
  if (root == nullptr) {
    return std::nullopt;
  }
  require(front.facts.base_error == 0.0, path,
          "there are the heights of a raster, yet the file left samples out");
  require(root->bytes == layout::kNodeBytes && nodes->bytes % layout::kNodeBytes == 0, path,
          "the nodes above the heights are no whole number of nodes long");
  require(pages->bytes > 0 && pages->bytes % layout::kFloorPageBytes == 0, path,
          "the heights are no whole number of pages long");
  require(root->offset % layout::kNodeBytes == 0 && nodes->offset % layout::kNodeBytes == 0 &&
              pages->offset % layout::kFloorPageBytes == 0,
          path, "the heights do not begin at a multiple of 4096 bytes");
  return FloorPlace{
      root->offset, root->checksum, {nodes->offset, nodes->bytes}, {pages->offset, pages->bytes}};
}

}  // namespace

const char* name_of(SectionKind kind) noexcept {
  switch (kind) {
    case SectionKind::kMetadata:
      return "metadata";
    case SectionKind::kT0Vertices:
      return "t0 vertices";
    case SectionKind::kT0Triangles:
      return "t0 triangles";
    case SectionKind::kErrorTable:
      return "error table";
    case SectionKind::kIndex:
      return "index";
    case SectionKind::kPages:
      return "pages";
    case SectionKind::kDirectory:
      return "directory";
    case SectionKind::kDirectoryNodes:
      return "directory nodes";
    case SectionKind::kFloorRoot:
      return "height root";
    case SectionKind::kFloorNodes:
      return "height nodes";
    case SectionKind::kFloorPages:
      return "heights";
    case SectionKind::kSegments:
      return "segments";
  }
  return "unknown";
}

/// What of the front of a far file did not come with its opening comes at once, the upper levels of
/// the index too.
void announce_front(const StoreFront& front, const ReadableFile& file) {
  if (!file.is_far()) {
    return;
  }
  constexpr std::uint64_t kMostUpperNodes = 16;
  // The segments, which come with it, tell exactly; they add few leaves and hardly ever a node above.
  const IndexShape index(front.header.page_count);
  const SectionEntry* const place = find_any(front.sections, SectionKind::kIndex, file.path());
  if (place == nullptr) {
    return;  // told by who needs it
  }
  const std::uint64_t upper = std::min(index.upper_nodes(), kMostUpperNodes);
  const ByteRange whole{0, place->offset + std::min(upper * layout::kNodeBytes, place->bytes)};
  file.will_need(std::span(&whole, 1));
}

StoreFront read_front(const ReadableFile& file) {
  StoreFront front{};
  front.header = read_header(file);
  check_header(front.header, file);
  front.facts = facts_of(front.header);
  front.sections = read_table(front.header, file);
  announce_front(front, file);
  place_index_and_pages(front, file);
  front.directory = place_of_directory(front, file.path());
  front.floor = place_of_floor(front, file.path());
  front.form = {front.header.major_version, front.floor.has_value()};
  const std::vector<char> metadata =
      read_section<char>(front.sections, SectionKind::kMetadata, file);
  front.metadata.assign(metadata.begin(), metadata.end());
  if (nesting_of(front.metadata) > kMostNesting) {
    throw Error(ErrorCode::corruption, "the metadata is nested deeper than any program writes",
                file.path());
  }
  front.t0 = read_t0(front.sections, front.facts, file);
  front.bins = read_bins(front.sections, front.header, file);
  return front;
}

}  // namespace ptin
