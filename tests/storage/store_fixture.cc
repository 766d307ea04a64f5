// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/storage/store_fixture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <span>
#include <tuple>

#include "storage/sample_heights.h"
#include "storage/short_float.h"
#include "tests/support/kept_interval.h"

namespace ptin::test {

namespace fs = std::filesystem;

Bytes read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  Bytes bytes(fs::file_size(path));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

void write_file(const std::string& path, const Bytes& bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

void append(StarredRecords& to, const StarredRecords& records) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::span<const RingCorner> ring = records.ring(i);
    add_star(to, records.splits[i], {ring.begin(), ring.end()});
  }
}

StarredRecords StoreContent::all_records() const {
  StarredRecords all;
  for (const StarredRecords& s : segments) append(all, s);
  return all;
}

StoreContent flat_square(std::int32_t side, HeightType type) {
  return flat_rectangle(side, side, type);
}

StoreContent flat_rectangle(std::int32_t width, std::int32_t height_of_it, HeightType type) {
  StoreContent c;
  c.facts.map = {500000.0, 4000000.0, 30.0, 30.0};
  if (type == HeightType::int32) {
    c.facts.heights = {HeightType::int32, 0.25, 100.0};
  }
  c.facts.bounds = {0, 0, width, height_of_it};
  c.facts.min_height = -100.0;
  c.facts.max_height = 4000.0;
  c.facts.source_samples = 5;  // one was left out: the range of heights is not the vertices'
  const HeightBits height = c.facts.heights.bits(12.0);
  c.t0.vertices = {{{0, 0}, height, 1},
                   {{width, 0}, height, 1},
                   {{width, height_of_it}, height, 1},
                   {{0, height_of_it}, height, 1}};
  c.t0.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
  return c;
}

namespace {

class RecordMaker {
 public:
  RecordMaker(const RandomRecords& options, const HeightEncoding& heights)
      : options_(options), heights_(heights), random_(options.seed) {}

  void add_to(StarredRecords& records) {
    VertexSplit r;
    do {
      r.u = {coordinate(1, options_.side - 1), coordinate(1, options_.side - 1)};
    } while (!seen_.insert(key_of(r.u)).second);
    const auto reach = static_cast<std::int32_t>(std::exp2(real(0.0, std::log2(options_.side))));
    const GridBox square{0, 0, options_.side, options_.side};
    std::vector<RingCorner> ring;
    const auto degree = static_cast<std::size_t>(coordinate(3, 9));
    for (const GridPoint p : made_ring(r.u, square, degree, reach, random_)) {
      ring.push_back({p, 0, kLivesOn, 0});
    }
    fill_heights(r, ring);
    fill_errors(r, ring);
    r.rank = static_cast<std::uint16_t>(coordinate(0, 300));
    name_by_ring(r, ring);
    r.roi = united(box_of(r.u), near(r.u, reach));
    hold_ring(r, ring, heights_);
    add_star(records, r, ring);
  }

 private:
  std::int32_t coordinate(std::int32_t lo, std::int32_t hi) {
    return std::uniform_int_distribution<std::int32_t>(lo, hi)(random_);
  }
  double real(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }

  GridPoint near(GridPoint u, std::int32_t reach) {
    for (;;) {
      const GridPoint p{std::clamp(u.x + coordinate(-reach, reach), 0, options_.side),
                        std::clamp(u.y + coordinate(-reach, reach), 0, options_.side)};
      if (!(p == u)) {
        return p;
      }
    }
  }
  HeightBits height(double h) { return heights_.bits(std::floor(h)); }

  void fill_heights(VertexSplit& r, std::vector<RingCorner>& ring) {
    const double base = real(0.0, 3000.0);
    const bool is_void = coordinate(0, 19) == 0;
    r.height = is_void ? 0 : height(base);
    r.height_lo = height(is_void ? 1.0 : base - real(0.0, 50.0));  // empty where lo > hi
    r.height_hi = height(is_void ? 0.0 : base + real(0.0, 50.0));
    r.flags = is_void ? VertexSplit::kVertexVoid : 0;
    for (RingCorner& c : ring) {
      c.flags = is_void ? RingCorner::kVoid | RingCorner::kNoHeight : 0;
      c.height = is_void ? 0 : height(base + real(-50.0, 50.0));
    }
    if (!is_void && coordinate(0, 19) == 0) {  // the border of a void
      ring.front().flags = RingCorner::kVoid;
      ring.back().flags = RingCorner::kVoid | RingCorner::kNoHeight;
      ring[ring.size() - 2].flags = RingCorner::kVoid;
      ring.back().height = 0;
    }
  }
  void fill_errors(VertexSplit& r, std::vector<RingCorner>& ring) {
    const int kind = coordinate(0, 19);
    r.error = kind == 0   ? 0.0F
              : kind == 1 ? std::numeric_limits<float>::infinity()
                          : shortened(static_cast<float>(std::exp2(real(-6.0, 8.0))));
    r.deviation = shortened(r.error * static_cast<float>(real(1.0, 1.5)));
    for (RingCorner& c : ring) {
      const auto share = static_cast<float>(real(-1.0, 1.0));
      c.death = share < 0.0F ? kLivesOn : share == 0.0F ? 0.0F : shortened(r.error * share);
    }
  }

  RandomRecords options_;
  HeightEncoding heights_;
  std::mt19937_64 random_;
  std::set<VertexKey> seen_;
};

}  // namespace

StoreContent random_content(const RandomRecords& options) {
  StoreContent c = flat_square(options.side, options.type);
  RecordMaker maker(options, c.facts.heights);
  for (std::size_t s = 0; s < options.segments; ++s) {
    auto& segment = c.segments.emplace_back();
    for (std::size_t i = 0; i < options.records; ++i) {
      maker.add_to(segment);
    }
  }
  c.facts.source_samples = 5 + options.segments * options.records;
  return c;
}

void write_store(const std::string& path, const StoreContent& content,
                 const StoreWriterOptions& options) {
  const auto writer = StoreWriter::create(path, options);
  const PageForm form{.has_floor = static_cast<bool>(content.add_floor)};
  for (const StarredRecords& segment : content.segments) {
    writer->add_segment(pack_segment(segment, content.facts.heights, form, options.page_bytes),
                        content.facts.heights);
  }
  if (content.add_floor) content.add_floor(*writer);
  writer->publish(content.facts, content.t0, content.metadata);
}

std::vector<VertexSplit> read_all(const StoreFile& store) {
  std::vector<VertexSplit> all;
  IoCounters counters;
  SampleHeights samples;
  for (std::uint64_t i = 0; i < store.pages().page_count(); ++i) {
    store.read_records(PageId{i}, all, samples, counters);
  }
  return all;
}

StarredRecords read_all_starred(const StoreFile& store) {
  StarredRecords all;
  IoCounters counters;
  SampleHeights samples;
  for (std::uint64_t i = 0; i < store.pages().page_count(); ++i) {
    store.read_starred(PageId{i}, all, samples, counters);
  }
  return all;
}

namespace {

auto sort_key_of(const VertexSplit& r) { return std::tuple(r.rank, r.error, key_of(r.u)); }

}  // namespace

StarredRecords in_order(const StarredRecords& records, std::span<const std::uint32_t> order) {
  StarredRecords result;
  for (const std::uint32_t i : order) {
    const std::span<const RingCorner> ring = records.ring(i);
    add_star(result, records.splits[i], std::vector<RingCorner>(ring.begin(), ring.end()));
  }
  return result;
}

StarredRecords as_kept(StarredRecords records, HeightType type) {
  const auto normalized = [&](HeightBits h) {
    return height_of_ordered(ordered_height(h, type), type);
  };
  for (VertexSplit& r : records.splits) {
    if (r.has_height()) r.height = normalized(r.height);
    keep_interval(r, type);
  }
  for (RingCorner& c : records.corners) {
    c.height = c.has_height() ? normalized(c.height) : c.height;
  }
  return records;
}

StarredRecords as_on_page(const StarredRecords& records, HeightType type) {
  std::vector<std::uint32_t> order(records.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::uint32_t i) { return records.splits[i].error; });
  return as_kept(in_order(records, order), type);
}

StarredRecords sorted_by_key(const StarredRecords& records) {
  std::vector<std::uint32_t> order(records.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return sort_key_of(records.splits[a]) < sort_key_of(records.splits[b]);
  });
  return in_order(records, order);
}

bool are_same(const StarredRecords& a, const StarredRecords& b) {
  return a.splits == b.splits && a.corners == b.corners && a.ring_end == b.ring_end;
}

}  // namespace ptin::test
