// SPDX-License-Identifier: GPL-3.0-or-later
//
// What queries read, cold and warm: records, pages, bytes, faults and time, by reader and size of
// pages.
//
//   readers  mapped, pread (the two page stores, packed R-tree); spatialindex (mapped pages,
//            libspatialindex's tree); uring (mapped index, pages through io_uring with 64 reads
//            under way; checksums, no decoding)
//   queries  open; point: 64 regular places; window of 1/1000 (16 places) and 1/25 (8), full
//            detail; the whole terrain at 10 and 2 units of height. A query is search, announce,
//            read, decode and ask; splits are not applied.
//   cold     before each query the store is closed and dropped from the page cache by
//            posix_fadvise, mincore must then find nothing of it, and the store is opened again;
//            "open" is a line of its own, not part of the others
//   warm     the same query again on the store as the cold one left it
//
// Columns are means over the queries, times are medians. `device` is what the process asked of the
// block layer (read-ahead included), `resident` what of the file was in the page cache afterwards.
// Flags: N not cold (mincore found pages, or less came from the device than the pages that were
// read); F faster than the device: more bytes a second than the best of several parallel sequential
// passes with O_DIRECT gave just before, so that something below us held the data. Neither is a
// figure to quote. Cold speaks of this system's cache alone: what the disk, the host of a virtual
// machine or the network keeps cannot be dropped from here.
//
// usage: io RASTER [-o OUT.csv] [--pages KIB...]
// builds a store for each page size in the build folder first
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/support/cold_file.h"
#include "bench/support/scratch.h"
#include "bench/support/uring_pages.h"
#include "engine/construct/build.h"
#include "engine/error.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/retrieval.h"
#include "storage/file/checksum.h"
#include "storage/spatialindex_rtree.h"

namespace {

using namespace ptin;
using namespace ptin::bench;
using Clock = std::chrono::steady_clock;

enum class Reader { kMapped, kPread, kSpatialIndex, kUring };
constexpr const char* kReaderNames[] = {"mapped", "pread", "spatialindex", "uring"};

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

struct Query {
  std::string name;
  std::vector<PredicatePtr> places;
};

/// `count` windows of `share` of each side at regular places along the diagonals' grid.
Query windows(const StoreFacts& f, const std::string& name, double share, int row) {
  Query query{name, {}};
  const double width = double(f.bounds.max_x) - f.bounds.min_x;
  const double height = double(f.bounds.max_y) - f.bounds.min_y;
  for (int i = 0; i < row * row; ++i) {
    const double x = f.bounds.min_x + width * (1 - share) * (i % row + 0.5) / row;
    const double y = f.bounds.min_y + height * (1 - share) * (i / row + 0.5) / row;
    const MapPoint low = f.map.to_map(x, y),
                   high = f.map.to_map(x + width * share, y + height * share);
    query.places.push_back(meets_region(Window{low.x, low.y, high.x, high.y}, f.map));
  }
  return query;
}

std::vector<Query> queries_of(const StoreFacts& f) {
  std::vector<Query> queries = {windows(f, "point", 0, 8),
                                windows(f, "window 1/1000", std::sqrt(0.001), 4),
                                windows(f, "window 1/25", 0.2, 3)};
  for (const int tolerance : {10, 2}) {
    queries.push_back({"all at " + std::to_string(tolerance), {3, error_above(tolerance)}});
  }
  return queries;
}

/// What one query cost, or the mean of many.
struct Figures {
  double records = 0, examined = 0, pages = 0, nodes = 0, device_kib = 0, resident_kib = 0,
         major_faults = 0;
  std::vector<double> ms;
  bool not_cold = false;

  void add(const Figures& o) {
    records += o.records, examined += o.examined, pages += o.pages, nodes += o.nodes;
    device_kib += o.device_kib, resident_kib += o.resident_kib, major_faults += o.major_faults;
    ms.insert(ms.end(), o.ms.begin(), o.ms.end());
    not_cold = not_cold || o.not_cold;
  }
  [[nodiscard]] double median_ms() const {
    std::vector<double> sorted = ms;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2),
                     sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// A store opened through one reader.
class OpenStore {
 public:
  OpenStore(const std::string& path, Reader reader, const PageSlots& slots)
      : reader_(reader),
        slots_(slots),
        store_(StoreFile::open(
            path, reader == Reader::kPread ? PageAccess::kPread : PageAccess::kMapped)) {
    if (reader == Reader::kSpatialIndex) rival_ = SpatialIndexRTree::open(store_);
  }

  Figures run(const AttributePredicate& predicate) const {
    QueryContext context({.memory_bytes = UINT64_MAX}, "");
    const SystemReads before = SystemReads::now();
    const auto begin = Clock::now();
    if (reader_ == Reader::kUring) {
      read_pages_with_uring(predicate, context);
    } else {
      const RecordIndex& index =
          rival_ != nullptr ? static_cast<const RecordIndex&>(*rival_) : store_->index();
      context.cost.records_retrieved = retrieve({*store_, index}, predicate, 0, context).size();
    }
    Figures f;
    f.ms = {ms_since(begin)};
    const SystemReads reads = SystemReads::now().since(before);
    f.records = double(context.cost.records_retrieved);
    f.examined = double(context.cost.records_examined);
    f.pages = double(context.cost.io.pages);
    f.nodes = double(context.cost.io.index_nodes);
    f.device_kib = double(reads.device_bytes) / 1024;
    f.major_faults = double(reads.major_faults);
    f.resident_kib = double(resident_bytes(store_->path())) / 1024;
    return f;
  }

  /// Exits unless the last pages that came through io_uring are those of the page store.
  void require_same_bytes(const AttributePredicate& predicate) const {
    if (reader_ != Reader::kUring) return;
    IoCounters ignored;
    std::vector<PageId> pages;
    store_->index().search(predicate, pages, ignored);
    std::vector<std::byte> bytes(store_->pages().page_bytes());
    std::uint64_t sum = 0;
    for (const PageId id : pages) {
      store_->pages().read(id, bytes, ignored);
      sum ^= checksum_of(bytes);
    }
    if (sum != checksum_)
      throw Error(ErrorCode::internal, "io_uring read other bytes than the page store");
  }

 private:
  void read_pages_with_uring(const AttributePredicate& predicate, QueryContext& context) const {
    std::vector<PageId> pages;
    store_->index().search(predicate, pages, context.cost.io);
    std::uint64_t sum = 0;
    read_with_uring(store_->path(), slots_, pages,
                    [&](PageId, std::span<const std::byte> bytes) { sum ^= checksum_of(bytes); });
    context.cost.io.pages = pages.size();
    checksum_ = sum;
  }

  Reader reader_;
  PageSlots slots_;
  std::shared_ptr<const StoreFile> store_;
  std::unique_ptr<SpatialIndexRTree> rival_;
  mutable std::uint64_t checksum_ = 0;
};

/// Drops all files of a store; false when some of it stays.
bool drop(const std::string& path, Reader reader) {
  std::uint64_t left = drop_from_cache(path);
  if (reader == Reader::kSpatialIndex)
    left += drop_from_cache(path + ".sidx.dat") + drop_from_cache(path + ".sidx.idx");
  return left == 0;
}

class Report {
 public:
  Report(const std::string& csv, const DeviceSpeed& device) : device_(device) {
    if (!csv.empty()) csv_ = std::fopen(csv.c_str(), "w");
    const char* head =
        "page_kib,reader,cache,query,times,records,useful,pages,nodes,asked_kib,device_kib,"
        "resident_kib,"
        "major_faults,ms,flag\n";
    if (csv_ != nullptr) std::fputs(head, csv_);
    std::puts(
        "| page | reader | cache | query | records | useful | pages | nodes | asked KiB | device "
        "KiB | resident KiB | "
        "major faults | ms | |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  }
  ~Report() {
    if (csv_ != nullptr) std::fclose(csv_);
  }
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  void line(std::uint32_t page_kib, Reader reader, bool cold, const std::string& query,
            const Figures& f) {
    const auto n = double(f.ms.size());
    const double ms = f.median_ms(), asked = f.pages / n * page_kib + f.nodes / n * 4;
    std::string flag;
    if (cold && (f.not_cold || f.device_kib / n < 0.98 * f.pages / n * page_kib)) flag += "N";
    if (cold && f.device_kib / n * 1024 / 1e3 / ms > device_.sequential_mb_s * 1.05) flag += "F";
    const double useful = f.examined > 0 ? f.records / f.examined : 0;
    const char* names[] = {kReaderNames[static_cast<int>(reader)], cold ? "cold" : "warm"};
    if (csv_ != nullptr) {
      std::fprintf(csv_, "%u,%s,%s,%s,%.0f,%.1f,%.4f,%.2f,%.2f,%.1f,%.1f,%.1f,%.2f,%.4f,%s\n",
                   page_kib, names[0], names[1], query.c_str(), n, f.records / n, useful,
                   f.pages / n, f.nodes / n, asked, f.device_kib / n, f.resident_kib / n,
                   f.major_faults / n, ms, flag.c_str());
    }
    std::printf(
        "| %u | %s | %s | %s | %.0f | %.2f | %.1f | %.1f | %.0f | %.0f | %.0f | %.1f | %.3g | %s "
        "|\n",
        page_kib, names[0], names[1], query.c_str(), f.records / n, useful, f.pages / n,
        f.nodes / n, asked, f.device_kib / n, f.resident_kib / n, f.major_faults / n, ms,
        flag.c_str());
    std::fflush(stdout);
  }

 private:
  DeviceSpeed device_;
  std::FILE* csv_ = nullptr;
};

void measure_store(const std::string& path, std::uint32_t page_kib, Reader reader, Report& report) {
  const PageSlots slots = page_slots_of(path);
  const StoreFacts facts = StoreFile::open(path)->facts();
  if (reader == Reader::kSpatialIndex)
    SpatialIndexRTree::open(StoreFile::open(path));  // built here, opened below
  Figures open;
  std::vector<std::pair<std::string, std::array<Figures, 2>>> results;
  for (const Query& query : queries_of(facts)) {
    std::array<Figures, 2> figures;  // cold, warm
    for (const PredicatePtr& predicate : query.places) {
      const bool cold = drop(path, reader);
      const SystemReads before = SystemReads::now();
      const auto begin = Clock::now();
      const OpenStore store(path, reader, slots);
      Figures opened;
      opened.ms = {ms_since(begin)};
      const SystemReads reads = SystemReads::now().since(before);
      opened.device_kib = double(reads.device_bytes) / 1024;
      opened.major_faults = double(reads.major_faults);
      opened.resident_kib = double(resident_bytes(path)) / 1024;
      opened.not_cold = !cold;
      open.add(opened);
      figures[0].add(store.run(*predicate));
      figures[0].not_cold = figures[0].not_cold || !cold;
      figures[1].add(store.run(*predicate));
      store.require_same_bytes(*predicate);
    }
    results.emplace_back(query.name, figures);
  }
  report.line(page_kib, reader, true, "open", open);
  for (const auto& [name, figures] : results) {
    report.line(page_kib, reader, true, name, figures[0]);
    report.line(page_kib, reader, false, name, figures[1]);
  }
}

void run(const std::string& raster, const std::string& csv,
         const std::vector<std::uint32_t>& page_sizes) {
  const ScratchFolder folder;
  std::optional<Report> report;
  for (const std::uint32_t kib : page_sizes) {
    BuildOptions options;
    options.page_bytes = kib * 1024;
    const std::string path = folder.file("pages" + std::to_string(kib) + ".ptin");
    const BuildReport built = build({raster}, path, options, {});
    if (!report) {
      const DeviceSpeed device = measure_device(path);
      std::printf(
          "device: %.0f MB/s in order (8 readers, O_DIRECT), %.2f ms for 4 KiB anywhere\n\n",
          device.sequential_mb_s, device.random_4k_ms);
      report.emplace(csv, device);
    }
    std::fprintf(stderr, "%u KiB: %llu records, %.2f bytes a vertex\n", kib,
                 static_cast<unsigned long long>(built.records),
                 double(built.file_bytes) / double(built.vertices));
    for (const Reader reader :
         {Reader::kMapped, Reader::kPread, Reader::kSpatialIndex, Reader::kUring}) {
      if (reader == Reader::kUring && !has_uring()) {
        std::fputs("lines of uring left out: built without liburing\n", stderr);
        continue;
      }
      measure_store(path, kib, reader, *report);
    }
    std::remove(path.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What queries read, cold and warm");
  std::string raster, csv;
  std::vector<std::uint32_t> page_sizes = {4, 8, 16};
  app.add_option("RASTER", raster, "A raster that GDAL reads")->required();
  app.add_option("-o,--output", csv, "The CSV to write");
  app.add_option("--pages", page_sizes, "Page sizes, KiB");
  CLI11_PARSE(app, argc, argv);
  try {
    run(raster, csv, page_sizes);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "io: %s\n", e.what());
    return 70;
  }
  return 0;
}
