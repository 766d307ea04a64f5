// SPDX-License-Identifier: GPL-3.0-or-later
//
// When workers give memory back.
#include "engine/construct/piece_runner.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace ptin {
namespace {

/// Pieces of given sizes, one after the other.
class ListedPieces final : public PieceSource {
 public:
  explicit ListedPieces(std::vector<std::uint64_t> sizes) : sizes_(std::move(sizes)) {}
  std::optional<std::uint64_t> next_bytes() override {
    return next_ == sizes_.size() ? std::nullopt : std::optional(sizes_[next_]);
  }
  Piece take(int /*worker*/) override {
    const std::uint64_t bytes = sizes_[next_++];
    return {bytes, [this, bytes](const std::stop_token& /*stop*/) {
              return [this, bytes] { committed.push_back(bytes); };
            }};
  }
  std::vector<std::uint64_t> committed;

 private:
  std::vector<std::uint64_t> sizes_;
  std::size_t next_ = 0;
};

TEST(PieceRunner, GivesMemoryBackBeforePiecesThatAreLarger) {
  ListedPieces pieces({5, 5, 3, 9, 9, 1, 2});
  std::vector<std::size_t> given_back;
  std::vector<std::uint64_t> wanted;
  const PieceLimits limits{1, 10, [&](std::uint64_t bytes) {
                             given_back.push_back(pieces.committed.size());
                             wanted.push_back(bytes);
                           }};
  EXPECT_EQ(run_pieces(pieces, limits, {}), 9U);
  EXPECT_EQ(pieces.committed, (std::vector<std::uint64_t>{5, 5, 3, 9, 9, 1, 2}));
  EXPECT_EQ(given_back, (std::vector<std::size_t>{3, 6})) << "before the first 9, and before the 2";
  EXPECT_EQ(wanted, (std::vector<std::uint64_t>{9, 2}));
}

}  // namespace
}  // namespace ptin
