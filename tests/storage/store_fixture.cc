// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/storage/store_fixture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <span>
#include <tuple>

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

std::vector<VertexSplit> StoreContent::all_records() const {
  std::vector<VertexSplit> all;
  for (const auto& s : segments) {
    all.insert(all.end(), s.begin(), s.end());
  }
  return all;
}

StoreContent flat_square(std::int32_t side, HeightType type) {
  StoreContent c;
  c.facts.map = {500000.0, 4000000.0, 30.0, 30.0};
  if (type == HeightType::int32) {
    c.facts.heights = {HeightType::int32, 0.25, 100.0};
  }
  c.facts.bounds = {0, 0, side, side};
  c.facts.min_height = -100.0;
  c.facts.max_height = 4000.0;
  c.facts.source_samples = 5;  // one was left out: the range of heights is not the vertices'
  const HeightBits height = c.facts.heights.bits(12.0);
  c.t0.vertices = {{{0, 0}, height, 1},
                   {{side, 0}, height, 1},
                   {{side, side}, height, 1},
                   {{0, side}, height, 1}};
  c.t0.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
  return c;
}

namespace {

class RecordMaker {
 public:
  RecordMaker(const RandomRecords& options, const HeightEncoding& heights)
      : options_(options), heights_(heights), random_(options.seed) {}

  VertexSplit make() {
    VertexSplit r;
    do {
      r.u = {coordinate(1, options_.side - 1), coordinate(1, options_.side - 1)};
    } while (!seen_.insert(key_of(r.u)).second);
    const auto reach = static_cast<std::int32_t>(std::exp2(real(0.0, std::log2(options_.side))));
    r.w = near(r.u, reach);
    r.vl = near(r.u, reach);
    r.vr = near(r.u, reach);
    r.roi = united(united(united(box_of(r.u), r.w), r.vl), r.vr);
    r.roi = united(r.roi, near(r.u, reach));
    fill_heights(r);
    fill_errors(r);
    r.rank = static_cast<std::uint16_t>(coordinate(0, 300));
    return r;
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

  void fill_heights(VertexSplit& r) {
    const double base = real(0.0, 3000.0);
    r.height = height(base);
    r.height_lo = height(base - real(0.0, 50.0));
    r.height_hi = height(base + real(0.0, 50.0));
    if (coordinate(0, 19) == 0) {
      r.flags = VertexSplit::kVertexVoid | VertexSplit::kLeftVoid;
      r.height = 0;
      r.height_lo = height(1.0);  // empty: lo > hi
      r.height_hi = height(0.0);
    }
  }
  void fill_errors(VertexSplit& r) {
    const int kind = coordinate(0, 19);
    r.error = kind == 0   ? 0.0F
              : kind == 1 ? std::numeric_limits<float>::infinity()
                          : static_cast<float>(std::exp2(real(-6.0, 8.0)));
    r.deviation = r.error * static_cast<float>(real(1.0, 1.5));
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
      segment.push_back(maker.make());
    }
  }
  c.facts.source_samples = 5 + options.segments * options.records;
  return c;
}

void write_store(const std::string& path, const StoreContent& content,
                 const StoreWriterOptions& options) {
  const auto writer = StoreWriter::create(path, options);
  for (std::vector<VertexSplit> segment : content.segments) {
    writer->add_segment(segment, content.facts.heights);
  }
  writer->publish(content.facts, content.t0, content.metadata);
}

std::vector<VertexSplit> read_all(const StoreFile& store) {
  std::vector<VertexSplit> all;
  IoCounters counters;
  for (std::uint64_t i = 0; i < store.pages().page_count(); ++i) {
    store.read_records(PageId{i}, all, counters);
  }
  return all;
}

void sort_by_key(std::vector<VertexSplit>& records) {
  std::sort(records.begin(), records.end(), [](const VertexSplit& a, const VertexSplit& b) {
    return std::tuple(a.rank, a.error, key_of(a.u)) < std::tuple(b.rank, b.error, key_of(b.u));
  });
}

}  // namespace ptin::test
