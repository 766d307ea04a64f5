// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/points/point_portions.h"
#include "engine/construct/read/input_kind.h"
#include "engine/construct/read/tin_count.h"

namespace ptin {

namespace {

/// So many points of a text are looked at, to learn the length of a line.
constexpr std::size_t kLookedAt = 10000;
/// Bytes of a line of text, where the reader does not know how many it has read (.gz).
constexpr double kBytesOfPoint = 24.0;
/// A .gz file ends with the size of its text, modulo 4 GiB. One of fewer bytes than this is taken
/// to hold less than 4 GiB of text, so that its end is believed.
constexpr std::uint64_t kSurelySmall = std::uint64_t{256} << 20;
/// Bytes of text for each byte of a larger .gz file.
constexpr double kPackedTimes = 4.0;

/// The bytes of text in a .gz file of `packed` bytes, or an estimate of them.
double unpacked_bytes(const std::string& path, std::uint64_t packed) {
  if (packed >= kSurelySmall || packed < 4) {
    return static_cast<double>(packed) * kPackedTimes;
  }
  std::ifstream file(path, std::ios::binary);
  file.seekg(-4, std::ios::end);
  std::array<unsigned char, 4> b{};
  file.read(reinterpret_cast<char*>(b.data()), 4);
  const double last = b[0] + 256.0 * (b[1] + 256.0 * (b[2] + 256.0 * b[3]));
  return std::max(last, static_cast<double>(packed));
}

/// Estimates the points of a text from its size and the bytes that its first points take. Exact for
/// a text of fewer than kLookedAt points.
std::uint64_t points_of_text(const std::string& path, PointStream& stream) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(path, ignored);
  const std::uint64_t bytes = ignored ? stream.total() : size;
  std::vector<SourcePoint> batch;
  double looked_at = 0.0;
  while (looked_at < kLookedAt && stream.next(batch)) {
    looked_at += static_cast<double>(batch.size());
  }
  if (looked_at < kLookedAt) {
    return static_cast<std::uint64_t>(looked_at);  // that was all
  }
  const auto read = static_cast<double>(stream.done());
  const double of_point = read > 0.0 ? read / looked_at : kBytesOfPoint;
  const double all =
      stream.total() > 0 ? static_cast<double>(stream.total()) : unpacked_bytes(path, bytes);
  return static_cast<std::uint64_t>(std::ceil(all / of_point));
}

}  // namespace

std::uint64_t PointCount::of_tins_at_once(std::size_t processes) const noexcept {
  const auto last =
      of_tins.begin() + static_cast<std::ptrdiff_t>(std::min(processes, of_tins.size()));
  return std::accumulate(of_tins.begin(), last, std::uint64_t{0});
}

PointCount count_points(const std::vector<std::string>& inputs, const SourceOptions& options) {
  PointCount count;
  for (const std::string& input : inputs) {
    if (can_be_read_once_only(input)) {
      count.is_known = false;
      return count;
    }
    const PointFormat format = point_format_of(input, options.points);
    if (format == PointFormat::kTin) {
      const std::uint64_t vertices = count_tin_vertices(input, options.points.layer);
      count.points += vertices;
      count.of_tins.push_back(vertices);
      continue;
    }
    const auto stream = open_point_stream(input, options.points, options.nodata);
    count.points += format == PointFormat::kText ? points_of_text(input, *stream) : stream->total();
  }
  std::sort(count.of_tins.begin(), count.of_tins.end(), std::greater<>());
  count.points = std::max<std::uint64_t>(count.points, 3);
  count.may_be_less = !options.points.classes.empty() ||
                      options.points.returns != ReturnChoice::kAll || options.bbox ||
                      options.nodata;
  return count;
}

}  // namespace ptin
