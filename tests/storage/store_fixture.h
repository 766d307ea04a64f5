// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stores for tests: random records, and files damaged and sealed again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "storage/layout.h"
#include "storage/store_file.h"
#include "storage/store_writer.h"
#include "tests/storage/made_star.h"
#include "tests/storage/seal.h"
#include "tests/support/test_folder.h"

namespace ptin::test {

[[nodiscard]] Bytes read_file(const std::string& path);
void write_file(const std::string& path, const Bytes& bytes);

/// What a store is made from.
struct StoreContent {
  StoreFacts facts;
  CoarsestTin t0;
  std::string metadata = R"({"source": "a test"})";
  std::vector<StarredRecords> segments;
  std::function<void(StoreWriter&)> add_floor;  ///< Null: without the heights of a raster.

  [[nodiscard]] StarredRecords all_records() const;
};

/// Two triangles over a square of `side` grid units and no record; heights as float32, or as int32
/// in steps of 0.25.
[[nodiscard]] StoreContent flat_square(std::int32_t side, HeightType type = HeightType::float32);
[[nodiscard]] StoreContent flat_rectangle(std::int32_t width, std::int32_t height, HeightType type);

struct RandomRecords {
  std::uint64_t seed = 1;
  std::size_t segments = 3;
  std::size_t records = 1000;   ///< Of each segment.
  std::int32_t side = 1 << 20;  ///< Of the square.
  HeightType type = HeightType::float32;
};
/// Records that storage cannot tell from those of a terrain, with different u: small ones mostly, a
/// few as wide as the square, errors over many octaves, some 0, some infinite; some void. Their stars
/// are those of no mesh.
[[nodiscard]] StoreContent random_content(const RandomRecords& options);

/// Writes a store and publishes it.
void write_store(const std::string& path, const StoreContent& content,
                 const StoreWriterOptions& options = {});

/// All records of a store, page by page.
[[nodiscard]] std::vector<VertexSplit> read_all(const StoreFile& store);
[[nodiscard]] StarredRecords read_all_starred(const StoreFile& store);

/// Records as pages give them back: 0 in the place of -0, and the interval of heights wider where it spans
/// more than pages tell (tests/support/kept_interval.h).
[[nodiscard]] StarredRecords as_kept(StarredRecords records, HeightType type);
/// The records in the order of one page: errors descend, and those of one error stay as they are.
[[nodiscard]] StarredRecords as_on_page(const StarredRecords& records, HeightType type);

/// The records `order[0]`, `order[1]`, ... with their stars.
[[nodiscard]] StarredRecords in_order(const StarredRecords& records,
                                      std::span<const std::uint32_t> order);
/// Appends records with their stars.
void append(StarredRecords& to, const StarredRecords& records);
/// By rank, error and key, so that two lists can be compared.
[[nodiscard]] StarredRecords sorted_by_key(const StarredRecords& records);
[[nodiscard]] bool are_same(const StarredRecords& a, const StarredRecords& b);

/// A predicate from a function.
class FunctionPredicate final : public AttributePredicate {
 public:
  explicit FunctionPredicate(std::function<bool(const Attributes&)> f) : f_(std::move(f)) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override { return f_(a); }

 private:
  std::function<bool(const Attributes&)> f_;
};

}  // namespace ptin::test
