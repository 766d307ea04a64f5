// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/checksum.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace ptin {

std::uint64_t checksum_of(std::span<const std::byte> bytes) noexcept {
  return XXH3_64bits(bytes.data(), bytes.size());
}

struct RunningChecksum::State {
  XXH3_state_t xxh;
};

RunningChecksum::RunningChecksum() : state_(std::make_unique<State>()) {
  XXH3_64bits_reset(&state_->xxh);
}

RunningChecksum::~RunningChecksum() = default;

void RunningChecksum::add(std::span<const std::byte> part) noexcept {
  XXH3_64bits_update(&state_->xxh, part.data(), part.size());
  bytes_ += part.size();
}

std::uint64_t RunningChecksum::value() const noexcept { return XXH3_64bits_digest(&state_->xxh); }

}  // namespace ptin
