// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/frame_coder.h"

#include <cstring>

#include "engine/error.h"
#include "engine/geometry/key_table.h"
#include "engine/query/stream/cell_coder.h"
#include "engine/query/stream/split_symbols.h"

namespace ptin {

namespace {

CodedSplit head_at(std::span<const std::byte> coded, std::size_t at) noexcept {
  CodedSplit head{};
  std::memcpy(&head.w, &coded[at], 8);
  std::memcpy(&head.u, &coded[at + 8], 8);
  std::memcpy(&head.level, &coded[at + 16], 2);
  std::memcpy(&head.symbols, &coded[at + 18], 1);
  return head;
}

}  // namespace

FrameCoder::FrameCoder(std::vector<std::uint64_t> cell_vertices, std::string file)
    : file_(std::move(file)), cell_vertices_(std::move(cell_vertices)) {}

std::uint64_t FrameCoder::bytes_of(std::uint64_t splits) noexcept {
  // Symbols take 17 to 25 bytes; code less than 5. A w that its frame makes is looked up in a table.
  constexpr std::uint64_t kCoded = 2 * (CodedSplit::kBytes + 25);
  return splits * (kCoded + sizeof(SplitTurn) + 2 * sizeof(std::uint32_t) + 10) +
         KeyTable::bytes_for(splits / 2);
}

void FrameCoder::reject(const std::string& why) const {
  throw Error(ErrorCode::corruption, why + "; run verify, and build the file again", file_);
}

void FrameCoder::count_before() {
  before_.assign(1, 0);
  for (const std::uint64_t vertices : cell_vertices_) before_.push_back(before_.back() + vertices);
}

void FrameCoder::read(std::span<const std::byte> coded) {
  turns_.clear();
  places_.clear();
  for (std::size_t at = 0; at < coded.size();) {
    const CodedSplit head = head_at(coded, at);
    const bool is_new = head.w >= SplitTurn::kMadeHere;
    const std::uint64_t w =
        is_new ? head.w : before_[head.w >> 32] + static_cast<std::uint32_t>(head.w);
    turns_.push_back({w, head.u, head.level, static_cast<std::uint32_t>(turns_.size())});
    places_.push_back(static_cast<std::uint32_t>(at));
    at += CodedSplit::kBytes + head.symbols;
  }
}

/// Names the splits that make a w of their frame, which are known by its key.
void FrameCoder::find_makers() {
  std::size_t wanted = 0;
  for (const SplitTurn& turn : turns_) wanted += turn.w >= SplitTurn::kMadeHere ? 1 : 0;
  if (wanted == 0) return;
  KeyTable numbers(wanted);
  std::vector<std::uint32_t> makers;
  for (const SplitTurn& turn : turns_) {
    if (turn.w < SplitTurn::kMadeHere) continue;
    const auto next = static_cast<std::uint32_t>(makers.size());
    if (numbers.insert(turn.w - SplitTurn::kMadeHere, next)) makers.push_back(UINT32_MAX);
  }
  for (const SplitTurn& turn : turns_) {
    if (const std::uint32_t i = numbers.find(turn.u); i != KeyTable::kAbsent) makers[i] = turn.at;
  }
  for (SplitTurn& turn : turns_) {
    if (turn.w < SplitTurn::kMadeHere) continue;
    const std::uint32_t maker = makers[numbers.find(turn.w - SplitTurn::kMadeHere)];
    if (maker == UINT32_MAX) reject("records name a vertex that lies in no part of the domain");
    turn.w = SplitTurn::kMadeHere + maker;
  }
}

void FrameCoder::code(std::span<const std::byte> coded, std::uint64_t count,
                      std::vector<std::byte>& out) {
  count_before();
  read(coded);
  if (turns_.size() != count) reject("records lie in no part of the domain");
  find_makers();
  if (!put_in_order(turns_)) reject("a record does not come after the one that it needs");
  RangeEncoder coder(out);
  std::uint32_t level = 0;
  std::uint64_t last = 0;
  bool begins = true;
  for (const SplitTurn& turn : turns_) {
    begins = begins || turn.level != level;
    if (models_.begins_level(coder, begins)) last = 0;
    level = turn.level;
    begins = false;
    const std::uint64_t w =
        turn.w < SplitTurn::kMadeHere ? turn.w : before_.back() + (turn.w - SplitTurn::kMadeHere);
    models_.gap(coder, w - last);
    last = w;
    const std::size_t at = places_[turn.at];
    RecordedSymbols::code(coded.subspan(at + CodedSplit::kBytes, head_at(coded, at).symbols),
                          models_, coder);
  }
  coder.finish();
}

}  // namespace ptin
