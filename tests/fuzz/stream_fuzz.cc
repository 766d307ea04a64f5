// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a stream: nothing may escape but an Error, and the mesh is a valid TIN at any time.
// Input: whether it is sealed again, so that changes reach what lies behind the checksums; how it
// is cut into pieces; then the stream.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/stream/stream_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace ptin;

constexpr std::uint32_t kKinds[] = {1, 2, 3};

/// The digest of the vertices in a T0 frame.
std::uint64_t digest_of_t0(std::span<const std::byte> payload) {
  stream::T0Counts counts;
  std::memcpy(&counts, payload.data(), sizeof counts);
  std::uint64_t sum = 0;
  for (std::size_t at = sizeof counts, i = 0;
       i < counts.vertices && payload.size() - at >= sizeof(layout::T0Vertex);
       ++i, at += sizeof(layout::T0Vertex)) {
    layout::T0Vertex v;
    std::memcpy(&v, payload.data() + at, sizeof v);
    sum += stream::digest_of({v.x, v.y}, v.height, v.has_height != 0);
  }
  return sum;
}

/// Makes heads and checksums right, and the digest of T0, as far as frames can be told.
void seal(std::vector<std::byte>& bytes) {
  if (bytes.size() < sizeof(stream::Head)) {
    return;
  }
  const stream::Head head{stream::kMagic, stream::kMajorVersion, stream::kMinorVersion, 0};
  std::memcpy(bytes.data(), &head, sizeof head);
  std::size_t start = 0;
  std::uint32_t sequence = 0;
  for (std::size_t at = sizeof head; bytes.size() - at >= sizeof(stream::FrameHead); ++sequence) {
    stream::FrameHead f;
    std::memcpy(&f, bytes.data() + at, sizeof f);
    f.reserved = 0;
    f.sequence = sequence;
    f.kind = sequence < 2 ? kKinds[sequence] : (f.kind == 4 ? 4 : 3);
    f.bytes =
        static_cast<std::uint32_t>(std::min<std::size_t>(f.bytes, bytes.size() - at - sizeof f));
    const std::span<std::byte> payload(bytes.data() + at + sizeof f, f.bytes);
    if (sequence == 1 && payload.size() >= sizeof(stream::T0Counts)) {
      const std::uint64_t digest = digest_of_t0(payload);
      std::memcpy(bytes.data() + start + sizeof f + offsetof(stream::Start, base_digest), &digest,
                  sizeof digest);
      stream::FrameHead first;
      std::memcpy(&first, bytes.data() + start, sizeof first);
      first.checksum = stream::checksum_of_frame(
          first, std::span<const std::byte>(bytes.data() + start + sizeof f, first.bytes));
      std::memcpy(bytes.data() + start, &first, sizeof first);
    }
    if (sequence == 0) {
      start = at;
      if (f.bytes < sizeof(stream::Start)) {
        return;
      }
    }
    f.checksum = stream::checksum_of_frame(f, payload);
    std::memcpy(bytes.data() + at, &f, sizeof f);
    at += sizeof f + f.bytes;
  }
}

}  // namespace

PTIN_FUZZ_TARGET(stream, data, size) {
  if (size < 2) {
    return 0;
  }
  std::vector<std::byte> bytes(size - 2);
  std::transform(data + 2, data + size, bytes.begin(), [](std::uint8_t b) { return std::byte{b}; });
  if (data[0] % 2 == 1) {
    seal(bytes);
  }
  StreamReader reader("fuzz");
  try {
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t piece = std::min<std::size_t>(data[1] * 64U + 1, bytes.size() - at);
      at += reader.feed(std::span(bytes).subspan(at, piece));
    }
  } catch (const Error&) {
  }
  if (reader.has_mesh() && !validate(reader.tin()).empty()) {
    std::abort();
  }
  return 0;
}
