// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAS: airborne and terrestrial lidar points, uncompressed (ASPRS LAS 1.0 - 1.4, point formats 0 -
// 10).
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// What a LAS header says, checked against the file's size.
struct LasHeader {
  int minor_version = 0;
  int point_format = 0;            ///< 0 .. 10
  std::uint32_t record_bytes = 0;  ///< At least what the format needs; the rest are extra bytes.
  std::uint64_t first_point = 0;   ///< Byte offset.
  std::uint64_t points = 0;
  std::array<double, 3> scale{};  ///< > 0
  std::array<double, 3> offset{};
};

/// A LAS file as a stream of points. Points that are marked as withheld are left out, and those of
/// other classes than the chosen ones.
///
/// Coordinates are whole numbers of steps (`scale`) from an offset. Where the step is a power of
/// ten and the offset a whole number of steps they are decimals, exactly, and the step is the
/// grid's; else the step and offset of x and y (the smaller step) are the lattice. The CRS is that
/// of the WKT record, else of the GeoTIFF keys; one that is damaged or unknown to GDAL is an error
/// when it is resolved, not here.
class LasReader final : public PointStream {
 public:
  /// @throws Error  not_found, io_error    the file cannot be opened or read
  ///                invalid_argument       no LAS file; compressed (LAZ); a header that contradicts
  ///                                       itself or the file's size (truncated files); a class
  ///                                       beyond 0 .. 255
  ///                unsupported_version    of a later version than 1.4
  /// Memory: 256 KiB at a time of the points, and the records before them, at most 64 MiB of which
  /// are looked at.
  LasReader(std::string path, const PointChoice& choice);
  ~LasReader() override;

  [[nodiscard]] const LasHeader& header() const noexcept { return header_; }
  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override;
  [[nodiscard]] std::uint64_t left_out() const noexcept override { return left_out_; }
  [[nodiscard]] std::uint64_t done() const noexcept override { return read_; }
  [[nodiscard]] std::uint64_t total() const noexcept override { return header_.points; }

 private:
  struct File;
  /// How one coordinate's steps become a decimal.
  struct Axis {
    bool exact = false;  ///< mantissa = steps * scale + offset, in units of 10^-decimals
    std::int64_t scale = 1;
    std::int64_t offset = 0;
    int decimals = 0;
    double real_scale = 1.0, real_offset = 0.0;
    [[nodiscard]] Decimal decimal(std::int32_t steps) const noexcept;
  };
  [[nodiscard]] Axis make_axis(std::size_t i, bool powers_of_ten_only) const;
  void set_lattice();
  [[nodiscard]] bool wanted(const unsigned char* record) const;

  std::string path_;
  std::unique_ptr<File> file_;
  LasHeader header_;
  PointStreamFacts facts_;
  std::array<Axis, 3> axes_;
  std::bitset<256> classes_;  ///< Kept.
  std::vector<unsigned char> buffer_;
  std::uint64_t read_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace ptin
