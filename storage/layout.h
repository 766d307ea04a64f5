// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a .ptin file, structure by structure: where each field lies. What it means is in
// storage/FORMAT.md. Every structure has a fixed size, no padding and no bit-field; floating-point
// fields are kept as their bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace ptin::layout {

static_assert(std::endian::native == std::endian::little,
              "files are little-endian and read in place");

/// As in PNG: the first byte has its high bit set, and CR LF and Ctrl-Z follow the name, so that a
/// transfer as text is noticed at once.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'P', 'T', 'I', 'N', 0x0D, 0x0A, 0x1A};
/// What a stream begins with (engine/query/stream/stream_format.h): no store, and refused as such.
inline constexpr std::array<std::uint8_t, 8> kStreamMagic = {0x89, 'P',  'T',  'S',
                                                             0x0D, 0x0A, 0x1A, 0x0A};
/// The version that a writer writes. Files of the oldest version that is read have pages of another form.
inline constexpr std::uint16_t kMajorVersion = 3;
inline constexpr std::uint16_t kOldestMajorVersion = 2;
/// The newest minor version that is known of a major one.
[[nodiscard]] constexpr std::uint16_t newest_minor(std::uint16_t major) noexcept {
  return major == 2 ? 2 : 0;
}

inline constexpr std::uint32_t kMinPageBytes = 4096;
inline constexpr std::uint32_t kMaxPageBytes = 65536;
inline constexpr std::uint32_t kMaxSections = 64;

/// The first bytes of a file.
struct FileHeader {
  std::array<std::uint8_t, 8> magic;           //   0
  std::uint16_t major_version, minor_version;  //   8
  std::uint32_t header_bytes;                  //  12  256
  std::uint64_t file_bytes;                    //  16
  std::uint32_t page_bytes;                    //  24  power of two, 4096 to 65536
  std::uint32_t section_count;                 //  28
  std::uint64_t section_table_checksum;        //  32
  std::uint64_t page_count;                    //  40
  std::uint64_t first_page;                    //  48  the page that lies in slot 0
  std::uint64_t record_count;                  //  56
  std::uint32_t max_rank;                      //  64
  std::uint32_t height_type;                   //  68
  std::uint64_t height_step, height_offset;    //  72  double
  std::uint64_t origin_x, origin_y;            //  88  double
  std::uint64_t step_x, step_y;                // 104  double
  std::array<std::int32_t, 4> bounds;          // 120  min x, min y, max x, max y
  std::uint64_t min_height, max_height;        // 136  double
  std::uint64_t base_error, base_deviation;    // 152  double
  std::uint64_t source_samples;                // 168
  std::uint32_t flags;                         // 176  kFreeOfVoids
  std::array<std::uint8_t, 68> reserved;       // 180  zero
  std::uint64_t header_checksum;               // 248  of bytes 0 to 247
};
static_assert(sizeof(FileHeader) == 256 && offsetof(FileHeader, section_table_checksum) == 32 &&
              offsetof(FileHeader, max_rank) == 64 && offsetof(FileHeader, bounds) == 120 &&
              offsetof(FileHeader, source_samples) == 168 && offsetof(FileHeader, flags) == 176 &&
              offsetof(FileHeader, header_checksum) == 248);

inline constexpr std::uint32_t kFreeOfVoids = 1;  ///< Bit of FileHeader::flags.

enum class SectionKind : std::uint32_t {
  kMetadata = 1,
  kT0Vertices = 2,
  kT0Triangles = 3,
  kErrorTable = 4,
  kIndex = 5,
  kPages = 6,
  kDirectory = 7,       ///< Both or none.
  kDirectoryNodes = 8,  ///< Kept between the index and the pages.
  kFloorRoot = 9,       ///< All three or none. Kept before the index, which comes at the opening.
  kFloorNodes = 10,     ///< Those below the root. Kept behind the pages, as the next.
  kFloorPages = 11,
  kSegments = 12,  ///< Since version 3. Kept behind the table.
};

/// One line of the section table, which follows the header.
struct SectionEntry {
  std::uint32_t kind, reserved;
  std::uint64_t offset, bytes;
  std::uint64_t checksum;  ///< The section's; for kIndex that of the root node; 0 for kPages.
};
static_assert(sizeof(SectionEntry) == 32 && offsetof(SectionEntry, offset) == 8);

/// Pages of a segment: those behind the ones before it.
struct SegmentEntry {
  std::uint16_t last;  ///< Number of its last page within it.
};
static_assert(sizeof(SegmentEntry) == 2);

struct T0Vertex {
  std::int32_t x, y;
  std::uint32_t height, has_height;
};
static_assert(sizeof(T0Vertex) == 16);

struct T0Triangle {
  std::array<std::uint32_t, 3> v;
  std::uint16_t is_void, death;  ///< Death: 0, or the upper half of the float plus 1.
};
static_assert(sizeof(T0Triangle) == 16);

struct ErrorBinEntry {
  std::uint32_t upper, max_deviation;  ///< float
  std::uint64_t records, void_vertices;
};
static_assert(sizeof(ErrorBinEntry) == 24);

/// Describes a page (in a leaf) or a node (above).
struct NodeEntry {
  std::int32_t min_x, min_y, max_x, max_y;                      //  0  of the rois
  std::int32_t star_min_x, star_min_y, star_max_x, star_max_y;  // 16  of the stars
  std::uint32_t height_lo, height_hi;                           // 32  saturated, as HeightEncoding
  std::uint32_t star_height_lo, star_height_hi;                 // 40  of the stars' vertices
  std::uint16_t error_max, error_min;                           // 48  upper half of a float
  std::uint16_t deviation_max;                                  // 52
  std::uint16_t death_min;  // 54  0: a triangle lives on; else plus 1
  std::uint32_t records;    // 56  on the page; 0 above the leaves
  std::uint32_t reserved;   // 60  zero
  std::uint64_t checksum;   // 64  of the page or node described
};
static_assert(sizeof(NodeEntry) == 72 && offsetof(NodeEntry, star_min_x) == 16 &&
              offsetof(NodeEntry, height_lo) == 32 && offsetof(NodeEntry, error_max) == 48 &&
              offsetof(NodeEntry, records) == 56 && offsetof(NodeEntry, checksum) == 64);

inline constexpr std::size_t kNodeBytes = 4096;
inline constexpr std::uint32_t kFanOut = 56;

struct IndexNode {
  std::uint32_t level;    ///< 0 for a leaf.
  std::uint32_t entries;  ///< Entries in use; the others are zero.
  std::uint64_t number;   ///< Within its level; of a leaf as IndexShape::name_of().
  std::array<NodeEntry, kFanOut> entry;
  std::array<std::uint8_t, 48> unused;  ///< Zero.
};
static_assert(sizeof(IndexNode) == kNodeBytes && offsetof(IndexNode, entry) == 16);

/// The directory begins with this. Then come, for each cell, the lower half of the checksum of its
/// node (u32), the line that parts it from the cell before (u32; of cell 0 it is 0), and the number
/// of its entries (u16): a column each (storage/directory_cells.h).
struct DirectoryHead {
  std::uint32_t cells;       //  0  from 1 to kMostDirectoryCells
  std::uint16_t least;       //  4  short number of byte 1 of an error
  std::uint16_t step_shift;  //  6  from there on, the binary logarithm of the step of short numbers
  std::uint64_t entries;     //  8  of all cells
};
static_assert(sizeof(DirectoryHead) == 16 && offsetof(DirectoryHead, entries) == 8);
inline constexpr std::uint32_t kMostDirectoryCells = 65536;
inline constexpr std::size_t kDirectoryCellBytes = 10;
/// Bit of a line: it is one of equal y, not of equal x.
inline constexpr std::uint32_t kLineOfEqualY = 0x80000000U;

/// What the columns of a directory's node hold of a page, in this order; a column of four bytes an
/// entry has 32 bits for each, the others have one byte.
struct DirectoryEntry {
  std::uint32_t page;                  //  0
  std::uint32_t checksum;              //  4  lower half of the page's
  std::array<std::uint8_t, 4> box;     //  8  of the stars: min x, min y, max x, max y in the cell
  std::uint8_t error_max, death_min;   // 12  on the scale of the head
  std::array<std::uint8_t, 2> unused;  // 14  in no column
};
static_assert(sizeof(DirectoryEntry) == 16 && offsetof(DirectoryEntry, error_max) == 12);
inline constexpr std::size_t kDirectoryEntryBytes = 14;

inline constexpr std::uint32_t kFloorFanOut = 168;
inline constexpr std::size_t kFloorPageBytes = 4096;

/// Describes a page of heights (in a leaf) or a node (above).
struct FloorEntry {
  std::uint64_t first;            //  0  key of its first tile
  std::uint32_t least, greatest;  //  8  ordered heights of its samples; all void: UINT32_MAX and 0
  std::uint64_t checksum;         // 16
};
static_assert(sizeof(FloorEntry) == 24 && offsetof(FloorEntry, checksum) == 16);

/// A node above the pages of heights. What is told of the raster stands in the root; elsewhere it is 0.
struct FloorNode {
  std::uint8_t side_log2, coding;              //  0
  std::uint16_t flags;                         //  2
  std::uint32_t entries;                       //  4  in use; the others are zero
  std::uint64_t pages;                         //  8  of the section
  std::uint32_t width, height;                 // 16  samples
  std::uint64_t step;                          // 24  double
  std::uint64_t nodata;                        // 32  double
  std::uint32_t source_type;                   // 40
  std::array<std::uint8_t, 20> reserved;       // 44  zero
  std::array<FloorEntry, kFloorFanOut> entry;  // 64
};
static_assert(sizeof(FloorNode) == kNodeBytes && offsetof(FloorNode, entry) == 64);

/// A page of heights begins with this. Then come the entries of its tiles, then their bytes.
struct FloorPageHead {
  std::uint16_t tiles, bytes;  //  0  bytes in use, from the beginning of the page
  std::uint32_t least, span;   //  4  of the heights of its samples
  std::uint32_t reserved;      // 12  zero
};
static_assert(sizeof(FloorPageHead) == 16);

struct FloorTileEntry {
  std::uint16_t key;  //  0  beyond that of the page's first tile
  std::uint16_t end;  //  2  of its bytes, from the beginning of the page
  std::uint16_t least,
      greatest;  //  4  in 65535ths of the span, outward; all void: UINT16_MAX and 0
};
static_assert(sizeof(FloorTileEntry) == 8);

/// The most tiles that a page may hold: each has an entry, and a byte at least.
inline constexpr std::size_t kMostFloorTiles =
    (kFloorPageBytes - sizeof(FloorPageHead)) / (sizeof(FloorTileEntry) + 1);
/// Keys of the tiles of a page lie within so many.
inline constexpr std::uint64_t kMostFloorKeys = 65536;

/// What a page begins with: base and width of each column of numbers (storage/page_columns.h).
struct PageHeader {
  std::uint16_t records, ring_bytes;                          //  0
  std::uint32_t x, y, height;                                 //  4  bases
  std::uint16_t error, deviation, rank;                       // 16  bases
  std::uint8_t degree, offset_bits, height_bits, death_bits;  // 22  bases
  std::array<std::uint8_t, 17> width;                         // 26  of the columns, bits
  std::uint8_t void_bits, no_height_bits;                     // 43  0 or 1, of every corner
  std::uint8_t shift, shift_width;                            // 45  base and width; 2.x: 0
  std::uint8_t flags;                                         // 47  kLocalPage; 2.x: 0
};
static_assert(sizeof(PageHeader) == 48 && offsetof(PageHeader, error) == 16 &&
              offsetof(PageHeader, degree) == 22 && offsetof(PageHeader, width) == 26 &&
              offsetof(PageHeader, void_bits) == 43);

/// Bit of PageHeader::flags: the heights of the page's vertices are those of the raster's samples.
inline constexpr std::uint8_t kLocalPage = 1;
/// Records whose errors are found without those before.
inline constexpr std::uint32_t kErrorRun = 64;

/// The last bytes of a page are zero, so that a number of up to 57 bits is read by one load.
inline constexpr std::size_t kPageTailBytes = 8;
/// The most records that a page may hold: one for so many of its bytes.
inline constexpr std::size_t kLeastRecordBytes = 8;
/// Records in a run of rings whose place is kept.
inline constexpr std::uint32_t kRingRun = 16;
/// The most neighbours of a vertex that a record splits off.
inline constexpr std::uint32_t kMostDegree = 255;

template <class T>
inline constexpr bool kIsPlainBytes = std::is_trivially_copyable_v<T>&&
    std::is_standard_layout_v<T>&& std::has_unique_object_representations_v<T>;
static_assert(kIsPlainBytes<FileHeader> && kIsPlainBytes<SectionEntry> && kIsPlainBytes<T0Vertex> &&
              kIsPlainBytes<T0Triangle> && kIsPlainBytes<ErrorBinEntry> &&
              kIsPlainBytes<NodeEntry> && kIsPlainBytes<IndexNode> && kIsPlainBytes<PageHeader> &&
              kIsPlainBytes<DirectoryHead> && kIsPlainBytes<DirectoryEntry> &&
              kIsPlainBytes<FloorEntry> && kIsPlainBytes<FloorNode> &&
              kIsPlainBytes<FloorPageHead> && kIsPlainBytes<FloorTileEntry>);

/// Bits of the largest float that is an error or a deviation: +infinity. Every NaN and every
/// negative number, -0 too, has larger bits, so one unsigned comparison finds a valid value.
inline constexpr std::uint32_t kInfinityBits = 0x7F800000U;

[[nodiscard]] constexpr float to_float(std::uint32_t bits) noexcept {
  return std::bit_cast<float>(bits);
}
[[nodiscard]] constexpr double to_double(std::uint64_t bits) noexcept {
  return std::bit_cast<double>(bits);
}
/// Bits of a float; -0 becomes 0.
[[nodiscard]] constexpr std::uint32_t to_bits(float v) noexcept {
  return std::bit_cast<std::uint32_t>(v + 0.0F);
}
[[nodiscard]] constexpr std::uint64_t to_bits(double v) noexcept {
  return std::bit_cast<std::uint64_t>(v);
}

}  // namespace ptin::layout
