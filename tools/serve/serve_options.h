// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a service of terrains is started with.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/crs/base_map.h"
#include "tools/http/limits.h"
#include "tools/serve/public_address.h"

namespace ptin::serve {

/// A file under the name that clients know it by.
struct ServedFile {
  std::string id;  ///< Letters, digits, `-`, `_` and `.`.
  std::string path;
};

/// What one question may ask for. Beyond: 413, with the name of the limit as here.
struct QuestionLimits {
  std::size_t points = 10000;
  std::size_t pairs = 1000;
  std::size_t vertices = 500000;       ///< The most that a mesh or lines may have.
  std::size_t held_vertices = 500000;  ///< That a receiver of a stream has.
  std::size_t have = 64;               ///< Servings that a receiver has had.
  std::size_t pixels = std::size_t{4} << 20;
  std::uint64_t stream_bytes = std::uint64_t{256} << 10;     ///< Without `max_bytes`.
  std::uint64_t most_stream_bytes = std::uint64_t{4} << 20;  ///< With it.
  std::uint64_t question_memory = std::uint64_t{64} << 20;   ///< Memory for one question.
};

/// Who may read /metrics.
enum class MetricsFor : std::uint8_t {
  kDefault,  ///< Those with the token where there is one, or else everybody.
  kAll,
  kToken,
  kNobody
};

struct ServeOptions {
  std::vector<ServedFile> files;
  std::string listen = "127.0.0.1:8080";
  PublicAddress public_address;  ///< Unknown: trusted proxies tell it, or addresses are paths.
  http::Limits http;             ///< Its memory is divided by divide_memory().
  QuestionLimits question;
  std::uint64_t cache_bytes = std::uint64_t{32} << 20;  ///< Answers that are kept.
  std::string token;                                    ///< Empty: no question needs one.
  /// That pages may lay over all terrains, when a user wants it; empty tiles: over none. Without a value
  /// it is the one that each file names.
  std::optional<BaseMap> base_map;
  std::string cors_origin;  ///< Origin of pages that may read answers; "*" for all; empty: none.
  bool offers_files = false;
  MetricsFor metrics = MetricsFor::kDefault;
  std::string version;  ///< Version of the program; part of every ETag.
  /// What is done about freed memory beyond http.kept_bytes, and at rest: the program's to say, since its
  /// allocator is. Empty: nothing.
  std::function<void()> bound_freed_memory, give_back_freed_memory;
};

/// Divides the memory among the lanes: sweeps and tiles take all of a question's, points a quarter.
/// Of what is freed as much as one question takes is kept, or a quarter of what is given beyond a
/// question and the points that are answered beside it; so little that every point would have to look
/// at it is not kept.
/// Where no memory is given it is so much that every lane can be full, a sixth more for bodies and for
/// answers that are written, and what is kept.
inline void divide_memory(ServeOptions& options) noexcept {
  http::Limits& limits = options.http;
  const std::uint64_t threads = limits.threads, one = options.question.question_memory;
  limits.question_bytes = one;
  limits.point_bytes = one / 4;
  limits.kept_bytes = one;
  if (limits.memory_bytes != 0) {
    constexpr std::uint64_t kLeast = std::uint64_t{8} << 20;
    const std::uint64_t needed = one + threads * limits.point_bytes;
    const std::uint64_t beyond = limits.memory_bytes - std::min(limits.memory_bytes, needed);
    limits.kept_bytes = beyond / 4 < kLeast ? 0 : std::min(one, beyond / 4);
    return;
  }
  const std::uint64_t lanes = (threads + 1) * one + threads * (one / 4);
  limits.memory_bytes = lanes + lanes / 5 + (std::uint64_t{16} << 20) + limits.kept_bytes;
}

}  // namespace ptin::serve
