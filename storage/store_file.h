// SPDX-License-Identifier: GPL-3.0-or-later
//
// An open .ptin file: header, metadata, T0, index and record pages. storage/FORMAT.md has the
// bytes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/coarsest_tin.h"
#include "storage/file/announcer.h"
#include "storage/file/range_source.h"
#include "storage/file/replaced_file.h"
#include "storage/index.h"
#include "storage/page_store.h"
#include "storage/pending_split.h"
#include "storage/star.h"
#include "storage/store_facts.h"

namespace ptin {

class DescribedPageStore;
class IndexShape;
class Floor;
class IndexNodes;
class MappedFile;
class PackedRTree;
class PointDirectory;
class RangedFile;
class ReadableFile;
class ReadOnlyFile;
class RecordPage;
struct DirectoryPage;
class SampleHeights;
struct StoreFront;

/// One bin of the table of errors: the records with error in (previous upper, upper]. Bins ascend,
/// and each is an eighth of an octave wide. The first has upper 0 and holds records of error
/// exactly 0; the last may have upper +infinity.
struct ErrorBin {
  float upper = 0.0F;
  float max_deviation = 0.0F;  ///< Largest deviation in this bin alone.
  std::uint64_t records = 0;
  std::uint64_t void_vertices = 0;  ///< Those of the records whose vertex has no height.
};

struct SectionInfo {
  std::string name;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

enum class PageAccess { kMapped, kPread };

/// An open store. Immutable; shared by any number of queries and threads.
class StoreFile {
 public:
  /// Opens and checks: magic, version, size against the header, every section inside of the file,
  /// checksums of header, tables, metadata and T0. Index nodes and record pages are verified when
  /// they are first visited, or by verify(). Cost: a few reads at the front of the file; O(|T0|),
  /// whatever the number of records.
  /// @param announcer  Hears what is read next; null: the kernel does. The store shares it.
  /// @throws Error not_found, io_error, corruption, unsupported_version; invalid_argument when it
  ///               is no regular file, a stream, or begins like no store at all
  static std::shared_ptr<const StoreFile> open(const std::string& path,
                                               PageAccess access = PageAccess::kMapped,
                                               std::shared_ptr<Announcer> announcer = nullptr,
                                               ReplacedFile replaced = ReplacedFile::kRefused);
  /// The same of a file that lies elsewhere. Answers are the same; pages and nodes are read in rounds
  /// of ranges, and each is verified at every reading.
  /// @throws Error as above, and as RangeSource::read; not_found, io_error (the folder of the caches)
  static std::shared_ptr<const StoreFile> open(std::shared_ptr<RangeSource> source,
                                               const RemoteCaches& caches = {});
  StoreFile(const StoreFile&) = delete;
  StoreFile& operator=(const StoreFile&) = delete;
  ~StoreFile();

  [[nodiscard]] const std::string& path() const noexcept;
  [[nodiscard]] const StoreFacts& facts() const noexcept;
  /// CRS, options, source and counts, as UTF-8 JSON.
  [[nodiscard]] std::string_view metadata_json() const noexcept;
  [[nodiscard]] const CoarsestTin& t0() const noexcept;
  [[nodiscard]] std::uint64_t record_count() const noexcept;
  [[nodiscard]] std::uint16_t max_rank() const noexcept;
  [[nodiscard]] std::span<const ErrorBin> error_bins() const noexcept;
  [[nodiscard]] std::vector<SectionInfo> sections() const;
  [[nodiscard]] std::uint64_t file_bytes() const noexcept;
  /// What a file that lies elsewhere cost since its opening, which is counted, by all threads. None:
  /// the file is the system's.
  [[nodiscard]] std::optional<IoCounters> remote_cost() const noexcept;
  /// The checksum of the header. The header holds the checksum of the table with the checksums of
  /// all sections, and an index entry that of what it describes: so this one number stands for the
  /// content of the file.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept;
  [[nodiscard]] const RecordIndex& index() const noexcept;  ///< The packed R-tree.
  /// The same, for searches of stars (storage/packed_rtree.h).
  [[nodiscard]] const PackedRTree& star_index() const noexcept;
  /// Levels and nodes of the packed R-tree.
  [[nodiscard]] const IndexShape& index_shape() const noexcept;
  [[nodiscard]] const PageStore& pages() const noexcept;
  /// The directory, for points of a file that lies elsewhere; null when it does not, or has none.
  [[nodiscard]] const PointDirectory* directory() const noexcept;
  /// The heights of the raster that the terrain is of; null where the file has none. They are those of
  /// the full TIN's vertices, which are the raster's samples, and its triangles follow from them.
  /// @throws Error corruption, io_error  Cost: the first time one read.
  [[nodiscard]] const Floor* floor() const;

  /// What the descriptor of a page says.
  struct PageInfo {
    std::uint32_t records;
    Attributes attributes;  ///< Union and maximum over the page's records.
    double min_error;
    StarAttributes stars;  ///< The same over their stars.
  };
  /// @throws Error corruption
  [[nodiscard]] PageInfo page_info(PageId id) const;

  /// What looks at a page (storage/record_page.h), which is there for the call.
  using Look = std::function<void(const RecordPage&)>;
  /// Lets `look` look at a page where it lies. What it made of the page is worth nothing after an
  /// error: the file may lose bytes while they are looked at.
  /// @throws Error corruption, io_error; what `look` throws
  /// @param heights  Of vertices of local pages; of the query that reads.
  void look_at(PageId id, const Look& look, SampleHeights& heights, IoCounters& counters) const;
  /// The same of a page that the directory named, without its descriptor: stars are held against the
  /// bounds of the terrain, the page's largest error and its least death.
  void look_at(const DirectoryPage& page, const Look& look, SampleHeights& heights,
               IoCounters& counters) const;

  /// Decodes the records of a page, appending to `out`, each checked against the page's descriptor.
  /// On an error `out` is as before.
  /// @throws Error corruption, io_error
  void read_records(PageId id, std::vector<VertexSplit>& out, SampleHeights& heights,
                    IoCounters& counters) const;
  /// As read_records(), with the stars.
  void read_starred(PageId id, StarredRecords& out, SampleHeights& heights,
                    IoCounters& counters) const;
  /// As read_records(), for those records alone whose attributes satisfy `predicate`. The others
  /// are not decoded, and not checked. Returns the number of records examined: all records of the
  /// page.
  std::uint32_t read_matching(PageId id, const AttributePredicate& predicate,
                              std::vector<VertexSplit>& out, SampleHeights& heights,
                              IoCounters& counters) const;
  std::uint32_t read_matching(PageId id, const AttributePredicate& predicate,
                              std::vector<PendingSplit>& out, SampleHeights& heights,
                              IoCounters& counters) const;

  /// Announces pages that are read next, as PageStore; of a file that lies elsewhere the tiles too that
  /// have the heights of local ones. `ids` ascend.
  /// @throws Error corruption, io_error  what describes them, and the nodes above tiles, is read
  void announce(std::span<const PageId> ids, SampleHeights& heights, IoCounters& counters) const;
  /// Announces pages that the directory named: each alone, since few are wanted of many.
  void announce(std::span<const DirectoryPage> pages, IoCounters& counters) const noexcept;
  /// Announces the tiles that have the heights of local pages, by the boxes of their stars; a file that
  /// does not lie elsewhere needs none. @throws Error corruption, io_error  the nodes above tiles are read
  void announce_heights(std::span<const GridBox> stars, SampleHeights& heights,
                        IoCounters& counters) const;
  /// Announces them by small places that fine stars meet, before their pages are known. Where nodes above
  /// the tiles are not at hand they are announced; so this is called once more when something was read.
  void announce_heights_around(std::span<const GridBox> places, SampleHeights& heights,
                               IoCounters& counters) const;

 private:
  StoreFile(std::unique_ptr<ReadOnlyFile> file, PageAccess access);
  explicit StoreFile(std::unique_ptr<RangedFile> file);
  [[nodiscard]] SampleHeights* used(SampleHeights& heights, IoCounters& counters) const;
  void read_by_copies();
  void search_by_nodes();

  std::unique_ptr<const StoreFront> front_;
  std::unique_ptr<ReadableFile> file_;
  RangedFile* far_ = nullptr;  ///< `file_`, where it lies elsewhere.
  std::unique_ptr<MappedFile> mapping_;
  std::unique_ptr<IndexNodes> nodes_;
  std::unique_ptr<DescribedPageStore> pages_;
  std::unique_ptr<PackedRTree> index_;
  std::unique_ptr<PointDirectory> directory_;
  mutable std::atomic<const Floor*> floor_ = nullptr;  ///< Owned; made when it is first asked for.
};

}  // namespace ptin
