// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/verify.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>

#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/geometry/interval.h"
#include "engine/stop.h"
#include "storage/descriptor.h"
#include "storage/directory_cells.h"
#include "storage/error_table.h"
#include "storage/file/checksum.h"
#include "storage/file/read_only_file.h"
#include "storage/page_packer.h"
#include "storage/record_page.h"
#include "storage/store_front.h"
#include "storage/unique_keys.h"
#include "storage/verify_floor.h"
#include "storage/verify_t0.h"

namespace ptin {

namespace {

struct EnoughFaults {};  // thrown by report(), caught by verify_store()

class Verifier {
 public:
  Verifier(const std::string& path, const VerifyOptions& options, const std::stop_token& stop,
           const VerifyProgress& progress, VerifyReport& report)
      : file_(path), options_(options), stop_(stop), progress_(progress), report_(report) {}

  void run();

 private:
  void report(std::string what, std::string where);
  void open_floor();
  void look_at_sections();
  void check_stop() const;
  void read_in_parts(std::uint64_t begin, std::uint64_t end,
                     const std::function<void(std::span<const std::byte>)>& take);
  void look_for_zeros(std::uint64_t begin, std::uint64_t end, const std::string& where);
  void look_at_tree();
  void look_at_directory();
  // Looks at a node and at all below it. Returns the union over its entries; none when the node is
  // damaged.
  std::optional<layout::NodeEntry> look_at_node(std::uint32_t level, std::uint64_t number,
                                                std::uint64_t checksum);
  void look_at_entry(std::uint32_t level, const layout::NodeEntry& entry, std::uint64_t child,
                     const std::string& where);
  std::optional<layout::NodeEntry> look_at_page(PageId id, const layout::NodeEntry& descriptor);
  bool read_page(PageId id, const layout::NodeEntry& descriptor);
  [[nodiscard]] bool is_packed_so() const;
  void count(PageId id);
  void count_height(HeightBits bits);
  [[nodiscard]] bool has_heights_of_header(const VertexSplit& r) const;
  void compare_heights();
  void compare_totals();

  ReadOnlyFile file_;
  const VerifyOptions& options_;
  const std::stop_token& stop_;
  const VerifyProgress& progress_;
  VerifyReport& report_;

  StoreFront front_;
  std::unique_ptr<const Floor> floor_;  ///< Null: there is none, or it is damaged.
  SampleHeights samples_;
  IoCounters io_;
  std::optional<UniqueKeys> keys_;
  std::uint64_t pass_ = 0;
  std::uint64_t pages_done_ = 0;
  ErrorTable errors_;
  std::uint32_t max_rank_ = 0;
  bool makes_void_ = false;
  Interval heights_{kInfinity, -kInfinity};  // of the vertices that have one
  std::uint64_t vertices_with_height_ = 0;
  bool is_directory_whole_ = true;
  bool all_seen_ = true;  // no page was left out because of damage
  std::vector<std::byte> page_;
  StarredRecords records_;
};

bool is_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

// Whether two entries say the same of their records, bit for bit: every union has one form.
bool same(layout::NodeEntry a, const layout::NodeEntry& b) {
  a.records = b.records;
  a.checksum = b.checksum;
  return std::memcmp(&a, &b, sizeof a) == 0;
}

std::string page_name(PageId id) { return "page " + std::to_string(index_of(id)); }

void Verifier::report(std::string what, std::string where) {
  if (report_.faults.size() >= options_.max_faults) {
    report_.stopped_early = true;
    throw EnoughFaults{};
  }
  report_.faults.push_back({std::move(what), std::move(where)});
}

void Verifier::run() {
  try {
    front_ = read_front(file_);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::corruption) {
      throw;
    }
    // Without header and tables nothing else can be found.
    report(e.message(), "front of the file");
    return;
  }
  page_.resize(front_.facts.page_bytes);
  open_floor();
  look_at_sections();
  for (const std::string& fault : faults_of_cover(front_.t0, front_.facts.bounds)) {
    report(fault, "T0");
  }
  const std::uint64_t vertices = front_.header.record_count + front_.t0.vertices.size();
  // One more than may be reported is kept, so that the report can say that there are more.
  keys_.emplace(front_.facts.bounds, vertices, options_.memory_bytes, options_.max_faults + 1);
  report_.key_passes = keys_->passes();
  for (pass_ = 0; pass_ < keys_->passes(); ++pass_) {
    keys_->begin(pass_);
    for (const CoarsestTin::V& v : front_.t0.vertices) {
      keys_->add(v.position);
    }
    look_at_tree();
    keys_->end();
  }
  compare_totals();
  look_at_directory();
  if (front_.floor) {
    verify_floor(
        file_, front_,
        [this](std::string what, std::string where) { report(std::move(what), std::move(where)); },
        [this] { check_stop(); });
  }
  file_.check_unchanged();
}

// The heights that local pages leave to the raster's samples. What is wrong with their root,
// verify_floor() tells.
void Verifier::open_floor() {
  if (!front_.floor) {
    return;
  }
  try {
    floor_ = std::make_unique<const Floor>(file_, *front_.floor, front_.facts);
    samples_.use(*floor_, io_);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::corruption) {
      throw;
    }
  }
}

// Everything before the index and the pages: gaps, metadata, and sections of later minor versions.
void Verifier::look_at_sections() {
  if (!nlohmann::json::parse(front_.metadata, nullptr, false).is_object()) {
    report("the metadata is not a JSON object", "section \"metadata\"");
  }
  std::uint64_t end =
      sizeof(layout::FileHeader) + front_.sections.size() * sizeof(layout::SectionEntry);
  for (const layout::SectionEntry& s : front_.sections) {
    look_for_zeros(end, s.offset, "gap before byte " + std::to_string(s.offset));
    end = s.offset + s.bytes;
    const bool is_known =
        s.kind >= 1 && s.kind <= static_cast<std::uint32_t>(layout::SectionKind::kPages);
    if (is_known) {
      continue;
    }
    RunningChecksum checksum;
    read_in_parts(s.offset, end, [&](std::span<const std::byte> part) { checksum.add(part); });
    if (checksum.value() != s.checksum) {
      is_directory_whole_ = false;
      report("the section does not match its checksum",
             "section of kind " + std::to_string(s.kind) + " (" +
                 name_of(static_cast<layout::SectionKind>(s.kind)) + ")");
    }
  }
}

// Hands the bytes [begin, end) to `take`, piece by piece. The file names the lengths of its
// sections, so no section is read into memory as a whole.
void Verifier::read_in_parts(std::uint64_t begin, std::uint64_t end,
                             const std::function<void(std::span<const std::byte>)>& take) {
  std::vector<std::byte> bytes(std::size_t{1} << 16);
  while (begin < end) {
    check_stop();
    const std::span<std::byte> part(
        bytes.data(), static_cast<std::size_t>(std::min<std::uint64_t>(end - begin, bytes.size())));
    file_.read_at(part, begin);
    take(part);
    begin += part.size();
  }
}

void Verifier::look_for_zeros(std::uint64_t begin, std::uint64_t end, const std::string& where) {
  bool all_zero = true;
  read_in_parts(begin, end,
                [&](std::span<const std::byte> part) { all_zero = all_zero && is_zero(part); });
  if (!all_zero) {
    report("unused bytes are not zero", where);
  }
}

void Verifier::check_stop() const { stop_if_asked(stop_, "verification", file_.path()); }

void Verifier::look_at_tree() {
  if (front_.index.levels() > 0) {
    static_cast<void>(look_at_node(front_.index.levels() - 1, 0, front_.root_checksum));
  } else if (front_.root_checksum != 0) {
    report("the checksum of an index without nodes should be 0", "section \"index\"");
  }
}

// Makes the directory again, from its own lines and the index: all else follows from these.
void Verifier::look_at_directory() {
  if (!front_.directory || !all_seen_ || !is_directory_whole_) {
    return;
  }
  const std::string where = "section \"directory\"";
  const DirectoryPlace& place = *front_.directory;
  std::optional<DirectoryRoot> root;
  try {
    root = DirectoryRoot::read(file_, place, front_.facts.bounds);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::corruption) {
      throw;
    }
    report(e.message(), where);
    return;
  }
  const PageNames names(front_.index, !front_.form.is_plain());
  if (!names.are_known()) {
    report("pages have no names in it: there are too many of them", where);
    return;
  }
  const PageWalk walk = [&](const PageVisitor& visit) {
    layout::IndexNode leaf;
    std::uint64_t page = 0;
    for (std::uint64_t number = 0; number < front_.index.nodes(0); ++number) {
      check_stop();
      file_.read_at(std::as_writable_bytes(std::span(&leaf, 1)),
                    front_.index_offset + front_.index.position(0, number) * layout::kNodeBytes);
      for (std::uint32_t i = 0; i < front_.index.entries(0, number); ++i) {
        visit(names.of(page++), leaf.entry[i]);
      }
    }
  };
  const std::vector<std::uint64_t> entries = count_entries(root->cells, walk);
  for (std::uint32_t cell = 0; cell < root->cells.count(); ++cell) {
    if (root->entries_of(cell) != entries[cell]) {
      report("cell " + std::to_string(cell) + " has another number of entries than pages", where);
      return;
    }
  }
  make_directory_nodes(
      root->cells, entries, root->scale, walk,
      [&](std::uint32_t cell, std::span<const std::byte> node) {
        std::vector<std::byte> found(node.size());
        file_.read_at(found, place.nodes.offset + root->range_of(cell).offset);
        if (!std::ranges::equal(found, node) ||
            static_cast<std::uint32_t>(checksum_of(node)) != root->checksums[cell]) {
          report("the node does not say what the index says of its pages",
                 "directory node " + std::to_string(cell));
        }
      });
}

std::optional<layout::NodeEntry> Verifier::look_at_node(std::uint32_t level, std::uint64_t number,
                                                        std::uint64_t checksum) {
  const std::string where =
      "index level " + std::to_string(level) + ", node " + std::to_string(number);
  layout::IndexNode node;
  file_.read_at(std::as_writable_bytes(std::span(&node, 1)),
                front_.index_offset + front_.index.position(level, number) * layout::kNodeBytes);
  const std::uint32_t entries = front_.index.entries(level, number);
  const bool is_damaged = checksum_of_object(node) != checksum;
  if (is_damaged || node.level != level || node.number != front_.index.name_of(level, number) ||
      node.entries != entries) {
    all_seen_ = false;
    if (pass_ == 0) {
      report(
          is_damaged
              ? "the node does not match the checksum that its parent holds; what lies below "
                "cannot be looked at"
              : "the node says another place or number of entries than follows from its position",
          where);
    }
    return std::nullopt;
  }
  report_.index_nodes += pass_ == 0 ? 1 : 0;
  const auto unused =
      std::as_bytes(std::span(&node, 1))
          .subspan(offsetof(layout::IndexNode, entry) + entries * sizeof(layout::NodeEntry));
  if (pass_ == 0 && !is_zero(unused)) {
    report("unused entries are not zero", where);
  }
  Descriptor all(front_.facts.heights);
  const std::uint64_t first = front_.index.first_child(level, number);
  for (std::uint32_t i = 0; i < entries; ++i) {
    look_at_entry(level, node.entry[i], first + i, where + ", entry " + std::to_string(i));
    all.add(node.entry[i]);
  }
  return all.entry();
}

void Verifier::look_at_entry(std::uint32_t level, const layout::NodeEntry& entry,
                             std::uint64_t child, const std::string& where) {
  if (!is_sound(entry, front_.facts.heights) || (level > 0 && entry.records != 0)) {
    all_seen_ = false;
    if (pass_ == 0) {
      report("the entry holds values that no program wrote", where);
    }
    return;
  }
  const std::optional<layout::NodeEntry> found =
      level == 0 ? look_at_page(PageId{child}, entry)
                 : look_at_node(level - 1, child, entry.checksum);
  if (pass_ == 0 && found && !same(*found, entry)) {
    report("the entry is not the union of what it describes", where);
  }
}

std::optional<layout::NodeEntry> Verifier::look_at_page(PageId id,
                                                        const layout::NodeEntry& descriptor) {
  check_stop();
  const bool is_read = read_page(id, descriptor);
  ++pages_done_;
  if (progress_ && pages_done_ % 4096 == 0) {
    progress_(pages_done_, front_.header.page_count * keys_->passes());
  }
  if (!is_read) {
    all_seen_ = false;
    return std::nullopt;
  }
  for (const VertexSplit& r : records_.splits) {
    keys_->add(r.u);
  }
  if (pass_ > 0) {
    return std::nullopt;
  }
  ++report_.pages;
  count(id);
  Descriptor all(front_.facts.heights);
  for (std::size_t i = 0; i < records_.size(); ++i) {
    all.add(records_.splits[i], records_.ring(i));
  }
  return all.entry();
}

// Fills `records_` with the records of a page. Returns false when the page is damaged, which is
// reported in the first pass.
bool Verifier::read_page(PageId id, const layout::NodeEntry& descriptor) {
  records_.clear();
  try {
    check_descriptor(file_.path(), id, descriptor, front_.facts.heights, front_.facts.page_bytes);
    file_.read_at(page_, front_.slots.offset_of(id));
    if (checksum_of(page_) != descriptor.checksum) {
      if (pass_ == 0) {
        report("the page does not match the checksum in its descriptor", page_name(id));
      }
      return false;
    }
    RecordPage(file_.path(), id, descriptor, front_.facts.heights, front_.form, page_,
               floor_ != nullptr ? &samples_ : nullptr)
        .decode(records_);
    if (pass_ == 0 && !is_packed_so()) {
      report("the page does not hold its records as they are to be packed", page_name(id));
    }
  } catch (const Error& e) {
    if (e.code() != ErrorCode::corruption) {
      throw;
    }
    if (pass_ == 0) {
      report(e.message(), page_name(id));
    }
    return false;
  }
  return true;
}

// Whether page_ is what a writer makes of records_: bases and widths are the least, and what is
// unused is zero.
bool Verifier::is_packed_so() const {
  PagePacker packer(front_.facts.page_bytes, front_.facts.heights, front_.form,
                    PagePacker::Packing::kAgain);
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (!packer.add(records_.splits[i], records_.ring(i))) {
      return false;
    }
  }
  layout::NodeEntry entry;
  return std::ranges::equal(packer.finish(entry), page_);
}

// Counts the records of a page, which are in `records_`, and looks at each.
void Verifier::count(PageId id) {
  report_.records += records_.size();
  for (const RingCorner& c : records_.corners) {
    makes_void_ = makes_void_ || c.flags != 0;
  }
  for (const VertexSplit& r : records_.splits) {
    const auto where = [&] {
      return page_name(id) + ", record of vertex (" + std::to_string(r.u.x) + ", " +
             std::to_string(r.u.y) + ")";
    };
    errors_.add(r);
    makes_void_ = makes_void_ || (r.flags & VertexSplit::kAnyVoid) != 0;
    max_rank_ = std::max<std::uint32_t>(max_rank_, r.rank);
    if (r.has_height()) {
      count_height(r.height);
    }
    if (!has_heights_of_header(r)) {
      report("an interval of heights reaches out of the least and largest in the header", where());
    }
    if (!contains(front_.facts.bounds, r.roi)) {
      report("a region of influence reaches out of the bounds", where());
    }
  }
}

void Verifier::count_height(HeightBits bits) {
  const double height = front_.facts.heights.height(bits);
  heights_ = {std::min(heights_.lo, height), std::max(heights_.hi, height)};
  ++vertices_with_height_;
}

// Whether the record's interval of heights lies within the header's, but for the unit to which it was
// rounded outward. That the interval holds the heights of u and of the ring, the page's reader has seen.
bool Verifier::has_heights_of_header(const VertexSplit& r) const {
  const StoreFacts& facts = front_.facts;
  const HeightEncoding& heights = facts.heights;
  if (is_empty(attributes_of(r, heights).heights)) {
    return true;
  }
  const auto ordered = [&](HeightBits bits) { return ordered_height(bits, heights.type); };
  const std::uint32_t lo = ordered(r.height_lo), hi = ordered(r.height_hi);
  const std::uint32_t unit_bits = front_.form.is_plain() ? 0 : kept_interval({lo, lo, hi}).shift;
  const auto height = [&](std::uint64_t o) {
    return heights.height(height_of_ordered(static_cast<std::uint32_t>(o), heights.type));
  };
  const std::uint64_t unit = std::uint64_t{1} << unit_bits;
  return height(std::min<std::uint64_t>(lo + unit - 1, hi)) >= facts.min_height &&
         height(std::max<std::uint64_t>(hi - (unit - 1), lo)) <= facts.max_height;
}

void Verifier::compare_totals() {
  for (const VertexKey key : keys_->twice()) {
    const GridPoint p = point_of(key);
    report("the vertex comes twice", "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")");
  }
  if (!all_seen_) {
    return;  // Sums over a part of the records say nothing.
  }
  if (report_.records != front_.header.record_count) {
    report("the header says " + std::to_string(front_.header.record_count) +
               " records, the pages hold " + std::to_string(report_.records),
           "header");
  }
  if (max_rank_ != front_.header.max_rank) {
    report("the header says that the largest rank is " + std::to_string(front_.header.max_rank) +
               ", it is " + std::to_string(max_rank_),
           "header");
  }
  compare_heights();
  if (front_.facts.free_of_voids && (makes_void_ || has_void(front_.t0))) {
    report("the header says that there are no voids, but there are", "header");
  }
  const std::vector<ErrorBin> bins = errors_.bins();
  const bool equal = std::equal(bins.begin(), bins.end(), front_.bins.begin(), front_.bins.end(),
                                [](const ErrorBin& a, const ErrorBin& b) {
                                  return a.upper == b.upper && a.max_deviation == b.max_deviation &&
                                         a.records == b.records &&
                                         a.void_vertices == b.void_vertices;
                                });
  if (!equal) {
    report("the table is not that of the records", "section \"error table\"");
  }
}

// Compares the least and largest height in the header with those of the vertices. They are those of
// all samples: the same where every sample with a height is a vertex with one; otherwise farther
// apart by at most the base error, unless samples fell into voids.
void Verifier::compare_heights() {
  for (const CoarsestTin::V& v : front_.t0.vertices) {
    if (v.has_height != 0) {
      count_height(v.height);
    }
  }
  const StoreFacts& facts = front_.facts;
  if (heights_.lo < facts.min_height || heights_.hi > facts.max_height) {
    report("the heights of the vertices reach out of the least and largest in the header",
           "header");
    return;
  }
  const bool all_are_vertices = vertices_with_height_ == facts.source_samples;
  if (vertices_with_height_ == 0 || !(all_are_vertices || facts.free_of_voids)) {
    return;
  }
  constexpr double kRounding = 1e-9;  // of doubles, generously
  const double most = all_are_vertices ? 0.0 : facts.base_error;
  const double slack =
      most + (most > 0 ? kRounding * (most + std::max(-heights_.lo, heights_.hi)) : 0.0);
  if (heights_.lo - facts.min_height > slack || facts.max_height - heights_.hi > slack) {
    report(
        "the least and largest height in the header are farther from those of the vertices than "
        "what was left out of the file can be",
        "header");
  }
}

}  // namespace

VerifyReport verify_store(const std::string& path, const VerifyOptions& options,
                          const std::stop_token& stop, const VerifyProgress& progress) {
  VerifyReport report;
  Verifier verifier(path, options, stop, progress, report);
  try {
    verifier.run();
  } catch (const EnoughFaults&) {
    // The report says so.
  }
  return report;
}

}  // namespace ptin
