// SPDX-License-Identifier: GPL-3.0-or-later
//
// When workers give memory back, and what becomes of what pieces and callbacks throw.
#include "engine/construct/tasks/piece_runner.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
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

/// As many pieces as there are, each of one byte; what is run is given with its number.
class NumberedPieces final : public PieceSource {
 public:
  using Run = std::function<std::function<void()>(int, const std::stop_token&)>;
  NumberedPieces(int count, Run run) : count_(count), run_(std::move(run)) {}
  std::optional<std::uint64_t> next_bytes() override {
    return next_ == count_ ? std::nullopt : std::optional<std::uint64_t>(1);
  }
  Piece take(int /*worker*/) override {
    return {1,
            [this, number = next_++](const std::stop_token& stop) { return run_(number, stop); }};
  }

 private:
  int count_, next_ = 0;
  Run run_;
};

/// What run_pieces() throws.
std::string thrown_by(PieceSource& source, const PieceLimits& limits) {
  try {
    run_pieces(source, limits, {});
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(PieceRunner, ThrowsWhatAPieceThrewOnceTheOthersHaveEnded) {
  for (const int threads : {1, 2, 3}) {
    SCOPED_TRACE(threads);
    std::atomic<int> running = 0, committed = 0;
    NumberedPieces pieces(50, [&](int number, const std::stop_token&) -> std::function<void()> {
      ++running;
      std::this_thread::yield();
      --running;
      if (number == 7) {
        throw std::runtime_error("the seventh");
      }
      return [&] { ++committed; };
    });
    EXPECT_EQ(thrown_by(pieces, {threads, 100, {}}), "the seventh");
    EXPECT_EQ(running, 0);
    EXPECT_LT(committed, 50);
  }
}

TEST(PieceRunner, ThrowsWhatACommitThrew) {
  for (const int threads : {1, 3}) {
    NumberedPieces pieces(50, [](int number, const std::stop_token&) -> std::function<void()> {
      return [number] {
        if (number == 20) {
          throw std::runtime_error("no room for the result");
        }
      };
    });
    EXPECT_EQ(thrown_by(pieces, {threads, 100, {}}), "no room for the result");
  }
}

TEST(PieceRunner, ThrowsWhatGivingMemoryBackThrew) {
  ListedPieces pieces({5, 9, 5});
  const PieceLimits limits{1, 10, [](std::uint64_t) { throw std::runtime_error("not mine"); }};
  EXPECT_EQ(thrown_by(pieces, limits), "not mine");
  EXPECT_EQ(pieces.committed, std::vector<std::uint64_t>{5});
}

}  // namespace
}  // namespace ptin
