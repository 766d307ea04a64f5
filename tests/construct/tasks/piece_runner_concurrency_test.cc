// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors of several workers at once.
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "engine/construct/tasks/piece_runner.h"

namespace ptin {
namespace {

/// One piece that waits until another does not fit, and that other.
class OneThatWaits final : public PieceSource {
 public:
  explicit OneThatWaits(const std::atomic<bool>& go_on) : go_on_(go_on) {}
  std::optional<std::uint64_t> next_bytes() override { return 6; }
  Piece take(int /*worker*/) override {
    return {6, [this](const std::stop_token&) -> std::function<void()> {
              while (!go_on_) {
                std::this_thread::yield();
              }
              throw std::runtime_error("of the piece");
            }};
  }

 private:
  const std::atomic<bool>& go_on_;
};

/// The one who gives back ends as the piece does: whatever both write must be in order.
TEST(PieceRunner, StandsErrorsOfAPieceAndOfGivingBackAtOnce) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<bool> go_on = false;
    OneThatWaits pieces(go_on);
    const PieceLimits limits{2, 10, [&](std::uint64_t) {
                               go_on = true;
                               throw std::runtime_error("of giving back");
                             }};
    std::string thrown;
    try {
      run_pieces(pieces, limits, {});
    } catch (const std::exception& e) {
      thrown = e.what();
    }
    EXPECT_TRUE(thrown == "of the piece" || thrown == "of giving back") << thrown;
  }
}

}  // namespace
}  // namespace ptin
