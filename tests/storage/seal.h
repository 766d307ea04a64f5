// SPDX-License-Identifier: GPL-3.0-or-later
//
// Changing a stored file and sealing it again: every checksum right, so that only a look at what
// the bytes mean can find the lie. Headers only: fuzz targets use it too.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "storage/file/checksum.h"
#include "storage/floor_shape.h"
#include "storage/index_shape.h"
#include "storage/layout.h"
#include "storage/page_slots.h"

namespace ptin::test {

using Bytes = std::vector<std::byte>;

template <class T>
inline T object_at(const Bytes& file, std::uint64_t offset) {
  T object;
  std::memcpy(&object, file.data() + offset, sizeof object);
  return object;
}

template <class T>
inline void set_object(Bytes& file, std::uint64_t offset, const T& object) {
  std::memcpy(file.data() + offset, &object, sizeof object);
}

inline bool holds(const Bytes& file, std::uint64_t offset, std::uint64_t bytes) {
  return offset <= file.size() && bytes <= file.size() - offset;
}

inline layout::FileHeader header_of(const Bytes& file) {
  return object_at<layout::FileHeader>(file, 0);
}
inline void set_header(Bytes& file, const layout::FileHeader& header) {
  set_object(file, 0, header);
}

inline std::vector<layout::SectionEntry> sections_of(const Bytes& file) {
  std::vector<layout::SectionEntry> sections;
  const std::uint32_t count = std::min(header_of(file).section_count, layout::kMaxSections);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t offset = sizeof(layout::FileHeader) + i * sizeof(layout::SectionEntry);
    if (holds(file, offset, sizeof(layout::SectionEntry))) {
      sections.push_back(object_at<layout::SectionEntry>(file, offset));
    }
  }
  return sections;
}

inline void set_sections(Bytes& file, const std::vector<layout::SectionEntry>& sections) {
  for (std::size_t i = 0; i < sections.size(); ++i) {
    set_object(file, sizeof(layout::FileHeader) + i * sizeof(layout::SectionEntry), sections[i]);
  }
}

inline layout::SectionEntry section_of(const Bytes& file, layout::SectionKind kind) {
  for (const auto& s : sections_of(file)) {
    if (s.kind == static_cast<std::uint32_t>(kind)) {
      return s;
    }
  }
  return {};
}

// The shape of a file's index; none of a file whose segments are not sound.
inline IndexShape shape_of(const Bytes& file, const layout::FileHeader& h) {
  if (h.major_version == 2) return IndexShape(h.page_count);
  const auto section = section_of(file, layout::SectionKind::kSegments);
  std::vector<std::uint64_t> segments;
  std::uint64_t left = h.page_count;
  for (std::uint64_t i = 0; i < section.bytes / sizeof(layout::SegmentEntry); ++i) {
    const std::uint64_t offset = section.offset + i * sizeof(layout::SegmentEntry);
    if (!holds(file, offset, sizeof(layout::SegmentEntry))) return {};
    const auto entry = object_at<layout::SegmentEntry>(file, offset);
    const std::uint64_t pages = std::uint64_t{entry.last} + 1;
    if (pages > left) return {};
    left -= pages;
    segments.push_back(pages);
  }
  return left == 0 ? IndexShape(segments) : IndexShape();
}

// Pages into leaves, leaves into the level above, and so on. Returns the checksum of the root.
inline std::uint64_t seal_index(Bytes& file, const layout::FileHeader& h) {
  const auto index = section_of(file, layout::SectionKind::kIndex);
  const auto pages = section_of(file, layout::SectionKind::kPages);
  if (h.page_count == 0 || h.page_bytes == 0 || h.page_count > file.size() / h.page_bytes) {
    return index.checksum;
  }
  const IndexShape shape = shape_of(file, h);
  if (shape.levels() == 0 || !holds(file, index.offset, shape.total_bytes()) ||
      h.first_page >= h.page_count) {
    return index.checksum;
  }
  const PageSlots slots{h.page_count, h.first_page, pages.offset, h.page_bytes};
  const auto node_offset = [&](std::uint32_t level, std::uint64_t number) {
    return index.offset + shape.position(level, number) * layout::kNodeBytes;
  };
  for (std::uint32_t level = 0; level < shape.levels(); ++level) {
    for (std::uint64_t child = 0; child < shape.children(level); ++child) {
      const std::uint64_t offset =
          level == 0 ? slots.offset_of(PageId{child}) : node_offset(level - 1, child);
      const std::uint64_t bytes = level == 0 ? h.page_bytes : layout::kNodeBytes;
      if (!holds(file, offset, bytes)) {
        return index.checksum;
      }
      const std::uint64_t sum = checksum_of(std::span(file).subspan(offset, bytes));
      const IndexShape::LeafEntry parent =
          level == 0 ? shape.leaf_entry(child)
                     : IndexShape::LeafEntry{child / layout::kFanOut,
                                             static_cast<std::uint32_t>(child % layout::kFanOut)};
      const std::uint64_t place =
          node_offset(level, parent.leaf) + offsetof(layout::IndexNode, entry) +
          parent.entry * sizeof(layout::NodeEntry) + offsetof(layout::NodeEntry, checksum);
      set_object(file, place, sum);
    }
  }
  return checksum_of(
      std::span(file).subspan(node_offset(shape.levels() - 1, 0), layout::kNodeBytes));
}

// The same of the heights of a raster: pages into leaves, up to the root.
inline void seal_floor(Bytes& file) {
  const auto root = section_of(file, layout::SectionKind::kFloorRoot);
  const auto nodes = section_of(file, layout::SectionKind::kFloorNodes);
  const auto pages = section_of(file, layout::SectionKind::kFloorPages);
  const std::uint64_t count = pages.bytes / layout::kFloorPageBytes;
  if (!holds(file, root.offset, layout::kNodeBytes) || !holds(file, nodes.offset, nodes.bytes) ||
      !holds(file, pages.offset, pages.bytes) || count == 0) {
    return;
  }
  const FloorTree tree(count);
  if (nodes.bytes / layout::kNodeBytes < tree.total_nodes() - 1) {
    return;
  }
  const auto node_offset = [&](std::size_t level, std::uint64_t number) {
    return level == 0 ? root.offset
                      : nodes.offset + (tree.position(level, number) - 1) * layout::kNodeBytes;
  };
  for (std::size_t level = tree.levels(); level-- > 0;) {
    for (std::uint64_t child = 0; child < tree.entries(level); ++child) {
      const std::uint64_t offset = level + 1 == tree.levels()
                                       ? pages.offset + child * layout::kFloorPageBytes
                                       : node_offset(level + 1, child);
      set_object(file,
                 node_offset(level, child / layout::kFloorFanOut) +
                     offsetof(layout::FloorNode, entry) +
                     child % layout::kFloorFanOut * sizeof(layout::FloorEntry) +
                     offsetof(layout::FloorEntry, checksum),
                 checksum_of(std::span(file).subspan(offset, layout::kNodeBytes)));
    }
  }
}

/// Computes every checksum again, as far as the structure can be followed: pages, leaves, inner
/// nodes, sections, table, header. Every byte pattern is safe to pass.
inline void seal(Bytes& file) {
  if (file.size() < sizeof(layout::FileHeader)) {
    return;
  }
  layout::FileHeader h = header_of(file);
  seal_floor(file);
  std::vector<layout::SectionEntry> sections = sections_of(file);
  for (auto& s : sections) {
    if (s.kind == static_cast<std::uint32_t>(layout::SectionKind::kIndex)) {
      s.checksum = seal_index(file, h);
    } else if (s.kind != static_cast<std::uint32_t>(layout::SectionKind::kPages) &&
               holds(file, s.offset, s.bytes)) {
      s.checksum = checksum_of(std::span(file).subspan(s.offset, s.bytes));
    }
  }
  set_sections(file, sections);
  h.section_table_checksum = checksum_of(std::as_bytes(std::span(sections)));
  h.header_checksum = checksum_of(
      std::as_bytes(std::span(&h, 1)).first(offsetof(layout::FileHeader, header_checksum)));
  set_header(file, h);
}

/// The file with one section more, of a later minor version, `bytes` long, behind the pages: header
/// and table speak of it, its bytes are for the caller to append. To be sealed.
inline Bytes with_room_for_a_section(const Bytes& file, std::uint64_t bytes) {
  // The table has no room for another line: the sections before the index move by one, into the
  // gap before it.
  std::vector<layout::SectionEntry> sections = sections_of(file);
  const std::uint64_t index = section_of(file, layout::SectionKind::kIndex).offset;
  std::uint64_t at =
      sizeof(layout::FileHeader) + (sections.size() + 1) * sizeof(layout::SectionEntry);
  Bytes result = file;
  std::fill(result.begin() + sizeof(layout::FileHeader),
            result.begin() + static_cast<std::ptrdiff_t>(index), std::byte{0});
  for (std::size_t i = 0; sections[i].offset < index; ++i) {
    if (at + sections[i].bytes > index) {
      throw std::runtime_error("there is no gap of 32 bytes before the index");
    }
    std::copy_n(file.begin() + static_cast<std::ptrdiff_t>(sections[i].offset), sections[i].bytes,
                result.begin() + static_cast<std::ptrdiff_t>(at));
    sections[i].offset = at;
    at = (at + sections[i].bytes + 7) / 8 * 8;
  }
  sections.push_back({99, 1, result.size(), bytes, 0});
  layout::FileHeader header = header_of(file);
  header.minor_version = layout::newest_minor(header.major_version) + 1;
  header.section_count = static_cast<std::uint32_t>(sections.size());
  header.file_bytes = result.size() + bytes;
  set_header(result, header);
  set_sections(result, sections);
  return result;
}

}  // namespace ptin::test
