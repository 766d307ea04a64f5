// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces of long answers, and what goes between them.
#include "tools/http/turns.h"

#include <functional>
#include <stdexcept>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <gtest/gtest.h>

namespace ptin::http {
namespace {

TEST(Turns, LetOthersGoBetweenThePieces) {
  boost::asio::io_context io{1};
  Turns turns(io.get_executor());
  constexpr int kWriters = 40;
  constexpr int kPiecesOfEach = 50;
  int pieces = 0;
  std::vector<int> left(kWriters, kPiecesOfEach);
  const std::function<void(std::size_t)> write = [&](std::size_t i) {
    ++pieces;
    if (--left[i] > 0) turns.wait([&, i] { write(i); });
  };
  for (std::size_t i = 0; i < kWriters; ++i) turns.wait([&, i] { write(i); });
  int rounds = 4;  // As a connection that is accepted, read and answered.
  int pieces_before_answer = -1;
  const std::function<void()> other = [&] {
    if (--rounds > 0) return boost::asio::post(io, other);
    pieces_before_answer = pieces;
  };
  boost::asio::post(io, other);
  io.run();
  EXPECT_LE(pieces_before_answer, 4);
  EXPECT_EQ(pieces, kWriters * kPiecesOfEach);
}

TEST(Turns, GoOnInTheirOrderBehindOneThatFails) {
  boost::asio::io_context io{1};
  Turns turns(io.get_executor());
  std::vector<int> had;
  turns.wait([&] { had.push_back(1); });
  turns.wait([] { throw std::runtime_error("no memory"); });
  turns.wait([&] { had.push_back(3); });
  EXPECT_THROW(io.run(), std::runtime_error);
  io.run();
  EXPECT_EQ(had, (std::vector<int>{1, 3}));
}

}  // namespace
}  // namespace ptin::http
