// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as nodes of an index whose checksums are right: searched both ways, with the same
// answer, and every page that is found described. Input: number of pages (2 bytes), then nodes,
// root first.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "engine/error.h"
#include "storage/descriptor.h"
#include "storage/index_nodes.h"
#include "storage/packed_rtree.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/storage/seal.h"

namespace {

using namespace ptin;

class Window final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return meets(a.roi, {1000, 1000, 600000, 600000}) && a.error > 0.5;
  }
};

// What the parents hold: the checksums, from the leaves up. Level and number are made right three
// times in four, so that most inputs get past them. Returns the root's checksum.
std::uint64_t seal_nodes(std::vector<layout::IndexNode>& nodes, const IndexShape& shape,
                         bool repair) {
  for (std::uint32_t level = 0; level < shape.levels(); ++level) {
    for (std::uint64_t number = 0; number < shape.nodes(level); ++number) {
      layout::IndexNode& node = nodes[shape.position(level, number)];
      if (repair) {
        node.level = level;
        node.number = number;
        node.entries = shape.entries(level, number);
      }
      if (level + 1 < shape.levels()) {
        layout::IndexNode& parent = nodes[shape.position(level + 1, number / layout::kFanOut)];
        parent.entry[number % layout::kFanOut].checksum = checksum_of_object(node);
      }
    }
  }
  return checksum_of_object(nodes[0]);
}

std::optional<std::vector<PageId>> search(const IndexNodes& nodes) {
  std::vector<PageId> pages;
  IoCounters counters;
  try {
    PackedRTree(nodes, {}).search(Window(), pages, counters);
  } catch (const Error&) {
    return std::nullopt;
  }
  return pages;
}

}  // namespace

PTIN_FUZZ_TARGET(packed_rtree, data, size) {
  if (size < 3) {
    return 0;
  }
  const std::uint64_t pages = 1 + (data[0] + 256U * data[1]) % 8000U;
  const IndexShape shape(pages);
  std::vector<layout::IndexNode> nodes(shape.total_nodes());
  // Short inputs are repeated: a damaged node is then in many places.
  for (layout::IndexNode& node : nodes) {
    std::memcpy(&node, data + 2, std::min(size - 2, sizeof node));
  }
  std::memcpy(nodes.data(), data + 2, std::min(size - 2, nodes.size() * sizeof nodes[0]));
  const std::uint64_t root = seal_nodes(nodes, shape, data[1] < 192);

  const int fd = ::memfd_create("nodes", MFD_CLOEXEC);
  const std::size_t bytes = nodes.size() * sizeof nodes[0];
  if (fd < 0 || ::write(fd, nodes.data(), bytes) != static_cast<ssize_t>(bytes)) {
    return 0;
  }
  const ReadOnlyFile file("/proc/self/fd/" + std::to_string(fd));
  const MappedFile mapping(file);
  const MappedIndexNodes mapped(file, mapping, {shape, 0, root}, {});
  const PreadIndexNodes pread(file, {shape, 0, root}, {});
  const auto first = search(mapped);
  if (first != search(pread) || first != search(mapped)) {
    std::abort();
  }
  for (const PageId id : first.value_or(std::vector<PageId>{})) {
    if (index_of(id) >= pages || !is_sound(mapped.descriptor(id), {}) ||
        mapped.descriptor(id).checksum != pread.descriptor(id).checksum) {
      std::abort();
    }
  }
  ::close(fd);
  return 0;
}
