// SPDX-License-Identifier: GPL-3.0-or-later
//
// A random terrain and the streams that are sent of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

#include "engine/query/questions.h"
#include "engine/query/stream/stream_writer.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin::reference {

using Bytes = std::vector<std::byte>;

/// A small terrain of random shape in a store, and what is asked of it.
struct Asked {
  explicit Asked(std::uint64_t seed)
      : random(seed),
        hierarchy(reference::random_hierarchy(seed)),
        file(hierarchy),
        store(file.open()),
        tin(store) {}
  [[nodiscard]] RefinedTin fresh(PredicatePtr p, std::optional<std::uint64_t> vertices = {}) const {
    RefineRequest request;
    request.also = p.get();
    request.detail.vertices = vertices;
    return tin.refine(request);
  }
  [[nodiscard]] std::size_t count(const AttributePredicate& p) const {
    return static_cast<std::size_t>(std::count_if(
        hierarchy.records.begin(), hierarchy.records.end(),
        [&](const auto& r) { return p.holds(attributes_of(r, hierarchy.facts.heights)); }));
  }
  std::mt19937_64 random;
  Hierarchy hierarchy;
  TemporaryStore file;
  std::shared_ptr<const StoreFile> store;
  Terrain tin;
};

/// A whole stream, in one piece.
inline Bytes sent(const std::shared_ptr<const StoreFile>& store, const StreamRequest& request,
                  StreamSummary* summary = nullptr) {
  Bytes bytes;
  const StreamSummary s =
      write_stream(OpenedTerrain(store), request, [&](std::span<const std::byte> piece) {
        bytes.insert(bytes.end(), piece.begin(), piece.end());
      });
  if (s.bytes != bytes.size()) {
    throw std::runtime_error("the summary says another number of bytes than were sent");
  }
  if (summary != nullptr) {
    *summary = s;
  }
  return bytes;
}

inline std::span<const std::byte> first(const Bytes& bytes, std::size_t n) {
  return {bytes.data(), n};
}

}  // namespace ptin::reference
