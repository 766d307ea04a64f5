// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/source_stage.h"

#include <charconv>
#include <numeric>

#include "engine/error.h"

namespace ptin {

std::vector<std::string> run_alone(const SourceStage& stage, StageWorker& worker) {
  return run_alone_within(stage, worker, 0, {}, {});
}

std::vector<std::string> run_alone_within(
    const SourceStage& stage, StageWorker& worker, std::uint64_t memory,
    const std::stop_token& stop,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress) {
  const std::uint64_t total =
      std::accumulate(stage.sizes.begin(), stage.sizes.end(), std::uint64_t{0});
  std::uint64_t before = 0;
  std::vector<std::string> results;
  for (std::size_t number = 0; number < stage.sizes.size(); ++number) {
    const auto tell = [&](std::uint64_t done) {
      if (progress) {
        progress(before + done, total);
      }
    };
    results.push_back(worker.run({stage.name, number, stage.facts, memory, stop, tell}));
    before += stage.sizes[number];
  }
  return results;
}

std::string digits_of(std::span<const std::byte> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::byte b : bytes) {
    text += kDigits[std::to_integer<unsigned>(b) >> 4U];
    text += kDigits[std::to_integer<unsigned>(b) & 15U];
  }
  return text;
}

void take_digits(const std::string& text, std::span<std::byte> bytes) {
  bool is_one = text.size() == 2 * bytes.size();
  for (std::size_t i = 0; is_one && i < bytes.size(); ++i) {
    unsigned value = 0;
    const char* const end = text.data() + 2 * i + 2;
    is_one = std::from_chars(end - 2, end, value, 16).ptr == end;
    bytes[i] = static_cast<std::byte>(value);
  }
  if (!is_one) {
    throw Error(ErrorCode::invalid_argument,
                "what another process of the build tells is not what this program expects; let all "
                "of them run the same program");
  }
}

}  // namespace ptin
