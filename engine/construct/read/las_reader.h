// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAS: airborne and terrestrial lidar points (ASPRS LAS 1.0 - 1.4, point formats 0 - 10), also
// compressed (LAZ, of which COPC is a kind).
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/point_classes.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

class LasFile;
struct HiddenLas14;
namespace laz {
class CompressedRecords;
}

/// What a LAS header says, checked against the file's size.
struct LasHeader {
  int minor_version = 0;
  int point_format = 0;            ///< 0 .. 10
  bool is_compressed = false;      ///< LAZ.
  std::uint32_t record_bytes = 0;  ///< A point; beyond what its format needs are extra bytes.
  std::uint64_t first_point = 0;   ///< Byte offset.
  std::uint64_t points = 0;
  std::uint64_t legacy_points = 0;      ///< 1.4: what the header says to readers of older versions.
  std::uint64_t header_bytes = 0;       ///< Where the variable length records begin.
  std::uint32_t records = 0;            ///< Those before the points.
  std::uint64_t first_extended = 0;     ///< Byte offset of those behind the points (1.4).
  std::uint32_t extended_records = 0;   ///< How many.
  std::uint64_t first_waveform = 0;     ///< Byte offset of waveforms in the file (1.3); 0: none.
  bool crs_is_wkt = false;              ///< Bit 4 of the global encoding.
  bool returns_are_made_up = false;     ///< Bit 3: return numbers were not measured.
  std::array<double, 3> scale{};        ///< Lengths of a step in x, y and z, > 0.
  std::array<double, 3> offset{};       ///< Coordinates of step 0.
  std::array<double, 3> low{}, high{};  ///< The box of all points, withheld ones included.
};

/// A LAS or LAZ file as a stream of points. Left out are points that are marked as withheld, and points of
/// classes and returns that were not chosen.
///
/// LAS coordinates are whole numbers of steps (`scale`) from an offset. Where the steps of x and y
/// are powers of ten, and their offsets whole numbers of steps, points are exact decimals and
/// facts() declares their digits. Otherwise facts() declares a lattice: the smaller of the two
/// steps as its unit, and the offsets. The CRS is that of declared_by_las() (read/las_crs.h).
class LasReader final : public PointStream {
 public:
  /// @throws Error  not_found, io_error    the file cannot be opened or read
  ///                invalid_argument       no LAS file; a header that contradicts itself or the
  ///                                       file's size (truncated files); damaged chunks; a class
  ///                                       beyond 0 .. 255
  ///                unsupported_version    of a later version than 1.4, or compressed by another
  ///                                       program than LASzip 2 to 3 and its like
  /// Memory: 256 KiB of the file's points at a time, compressed ones as laz::CompressedRecords; while
  /// the CRS is read, up to 64 MiB of records that declare it.
  /// @param part  The records that are read; beyond the last one there are none. Of compressed ones
  ///              the chunks that begin with one of them.
  LasReader(std::string path, const PointChoice& choice, const PointPart& part = {});
  ~LasReader() override;

  [[nodiscard]] const LasHeader& header() const noexcept { return header_; }
  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override;
  [[nodiscard]] LeftOutPoints left_out() const noexcept override { return left_out_; }
  [[nodiscard]] PointClasses classes() const override { return counted_; }
  [[nodiscard]] SourceWarnings warnings() const override;
  [[nodiscard]] std::uint64_t done() const noexcept override { return read_ - begin_; }
  [[nodiscard]] std::uint64_t total() const noexcept override { return end_ - begin_; }
  [[nodiscard]] std::uint64_t most_parts() const noexcept override;
  [[nodiscard]] bool is_compressed() const noexcept override { return header_.is_compressed; }

 private:
  /// How the steps of one coordinate become a decimal.
  struct Axis {
    /// True: the mantissa is steps * scale + offset. False: the double steps * real_scale +
    /// real_offset is rounded to `decimals` digits.
    bool exact = false;
    std::int64_t scale = 1;
    std::int64_t offset = 0;
    int decimals = 0;
    double real_scale = 1.0, real_offset = 0.0;
    [[nodiscard]] Decimal decimal(std::int32_t steps) const noexcept;
  };
  [[nodiscard]] Axis make_axis(std::size_t i, bool powers_of_ten_only) const;
  void set_lattice();
  void open_part(const PointPart& part);
  void read_records();
  void read_declarations();
  void warn(const char* kind, std::string message);
  void check_counts();
  [[nodiscard]] int class_of(const unsigned char* record) const noexcept;
  void look_at(const unsigned char* record, std::uint64_t point);
  [[nodiscard]] bool is_wanted_return(const unsigned char* record) const;
  void count_class(const unsigned char* record);
  [[nodiscard]] std::optional<LeftOutReason> why_unwanted(const unsigned char* record);

  std::string path_;
  std::unique_ptr<LasFile> file_;
  LasHeader header_;
  std::unique_ptr<HiddenLas14> hidden_;  ///< Null where there is nothing of LAS 1.4 hidden.
  bool is_old_ = false;                  ///< Flags, returns and class are those of formats 0 to 5.
  PointStreamFacts facts_;
  SourceWarnings warnings_;
  std::array<Axis, 3> axes_;
  std::bitset<256> classes_;  ///< Those that are kept.
  ReturnChoice returns_ = ReturnChoice::kAll;
  std::unique_ptr<laz::CompressedRecords> compressed_;  ///< Null where they are not.
  std::vector<unsigned char> buffer_;                   ///< Records, or how they begin.
  std::uint64_t step_ = 0;             ///< Bytes from one to the next in the buffer.
  std::uint64_t begin_ = 0, end_ = 0;  ///< The records of the part.
  std::uint64_t read_ = 0;             ///< The next record.
  LeftOutPoints left_out_;
  PointClasses counted_;
  bool has_box_ = false, names_classes_ = false;
  /// Steps of the header's box, one more on each side.
  std::array<double, 3> low_{}, high_{};
  /// Points that were handed out, and the number of the first of them.
  struct OddPoints {
    std::uint64_t count = 0, first = 0;
    void add(bool is_one, std::uint64_t point) noexcept {
      first = is_one && count == 0 ? point : first;
      count += is_one ? 1 : 0;
    }
  };
  OddPoints noise_, out_of_box_, odd_returns_;
};

}  // namespace ptin
