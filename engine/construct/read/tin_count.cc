// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/tin_count.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stop_token>
#include <utility>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/tin_file.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// Bytes of a vertex in text, where none was seen.
constexpr double kBytesOfVertex = 32.0;
/// Bytes of a triangle in text beside its three numbers, where no triangle was seen.
constexpr double kBytesOfTriangle = 5.0;

/// Counts vertices and triangles, and the bytes of the file that each kind takes.
class CountingSink final : public TinFileSink {
 public:
  explicit CountingSink(const ByteReader& in) : in_(in) {}

  void expect_vertices(std::uint64_t count) override { said_ = count; }
  void add_vertex(std::int64_t /*id*/, const SourcePoint& /*p*/) override {
    vertices_.add(passed());
  }
  void add_face(std::span<const std::int64_t> ids) override {
    triangles_.add(passed());
    triangles_.count += ids.size() - 3;
  }

  /// The number of vertices in the file's header, where there is one.
  [[nodiscard]] std::optional<std::uint64_t> said() const { return said_; }
  [[nodiscard]] std::uint64_t seen() const { return vertices_.count; }
  /// Vertices of a file of `bytes` bytes.
  [[nodiscard]] double estimate(double bytes) const {
    const double of_vertex = vertices_.mean(kBytesOfVertex);
    const double digits = std::max(1.0, std::floor(std::log10(bytes / (3.0 * of_vertex))));
    const double of_triangle = triangles_.mean(kBytesOfTriangle + 3.0 * (digits + 1.0));
    return bytes / (of_vertex + 2.0 * of_triangle);
  }

 private:
  struct Kind {
    std::uint64_t count = 0, bytes = 0;
    void add(std::uint64_t passed) {
      ++count;
      bytes += passed;
    }
    [[nodiscard]] double mean(double otherwise) const {
      return bytes > 0 ? static_cast<double>(bytes) / static_cast<double>(count) : otherwise;
    }
  };
  /// Bytes since the last call.
  std::uint64_t passed() { return in_.position() - std::exchange(at_, in_.position()); }

  const ByteReader& in_;
  std::uint64_t at_ = 0;
  Kind vertices_, triangles_;
  std::optional<std::uint64_t> said_;
};

}  // namespace

std::uint64_t count_tin_vertices(const std::string& path, const std::string& surface) {
  TinReader& read = tin_reader_of(path);
  ByteReader in(path);
  CountingSink sink(in);
  std::stop_source enough;  // seen when a reader first looks: after 65536 vertices and triangles
  enough.request_stop();
  try {
    static_cast<void>(read(in, {surface, enough.get_token(), {}}, sink));
    return sink.seen();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) {
      throw;
    }
  }
  return sink.said().value_or(std::max(
      sink.seen(), static_cast<std::uint64_t>(sink.estimate(static_cast<double>(in.size())))));
}

}  // namespace ptin
