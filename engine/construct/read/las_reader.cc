// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/laz/compressed_records.h"
#include "engine/construct/laz/las_value.h"
#include "engine/construct/read/las_crs.h"
#include "engine/construct/read/las_file.h"
#include "engine/construct/read/las_hidden.h"
#include "engine/construct/read/las_records.h"
#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::uint64_t kBatchBytes = std::uint64_t{1} << 18;
constexpr std::int64_t kMostMantissa = 1'000'000'000'000'000'000;
/// A scale with more digits after the point is taken for a binary fraction, not for a decimal.
constexpr int kMostScaleDecimals = 9;
constexpr int kOverlapClass = 12;

/// Where compressed points are and how they are compressed, which a record says.
laz::CompressedPoints compressed_points(const LasFile& file, const LasHeader& header,
                                        bool gives_extra) {
  laz::CompressedPoints points{
      {file.path(), file.bytes(),
       [&file](std::uint64_t offset, std::span<unsigned char> into) { file.read(offset, into); }},
      {},
      header.first_point,
      header.points,
      header.extended_records > 0 ? header.first_extended : 0};
  std::vector<unsigned char> layout;
  walk_records(file, records_before_points(file, header), [&](const LasRecordHead& record) {
    if (record.user == laz::kLayoutUser && record.id == laz::kLayoutRecord) {
      layout.resize(record.bytes);
      file.read(record.at, layout);
    }
  });
  points.layout = laz::read_layout(layout, header.point_format, header.record_bytes, file.path());
  points.layout.gives_extra = gives_extra;
  return points;
}

}  // namespace

/// Steps become decimals exactly where the scale is a short decimal and the offset has no more
/// digits after the point than the scale.
LasReader::Axis LasReader::make_axis(std::size_t i, bool powers_of_ten_only) const {
  Axis axis;
  axis.real_scale = header_.scale[i];
  axis.real_offset = header_.offset[i];
  // For steps that are no decimals: as many digits after the point as leave mantissas of 18 digits.
  const double reach = std::abs(header_.offset[i]) + header_.scale[i] * 2147483648.0;
  axis.decimals = std::clamp(17 - static_cast<int>(std::ceil(std::log10(reach))), 0, 17);
  const Decimal scale = decimal_of(header_.scale[i]);
  const Decimal offset = decimal_of(header_.offset[i]);
  if (scale.decimals > kMostScaleDecimals || offset.decimals > scale.decimals ||
      (powers_of_ten_only && scale.mantissa != 1)) {
    return axis;
  }
  const double shifted =
      static_cast<double>(offset.mantissa) * std::pow(10.0, scale.decimals - offset.decimals);
  if (std::abs(shifted) + static_cast<double>(scale.mantissa) * 2147483648.0 >
      static_cast<double>(kMostMantissa)) {
    return axis;
  }
  axis.exact = true;
  axis.scale = scale.mantissa;
  axis.decimals = scale.decimals;
  axis.offset = offset.mantissa * power_of_ten(scale.decimals - offset.decimals);
  return axis;
}

Decimal LasReader::Axis::decimal(std::int32_t steps) const noexcept {
  if (exact) {
    return {std::int64_t{steps} * scale + offset, decimals};
  }
  const double value = static_cast<double>(steps) * real_scale + real_offset;
  return {std::llround(value * static_cast<double>(power_of_ten(decimals))), decimals};
}

void LasReader::set_lattice() {
  axes_ = {make_axis(0, true), make_axis(1, true), make_axis(2, false)};
  if (axes_[0].exact && axes_[1].exact) {
    facts_.plan_decimals = std::max(axes_[0].decimals, axes_[1].decimals);
  } else {
    facts_.lattice = SourceLattice{std::min(header_.scale[0], header_.scale[1]), header_.offset[0],
                                   header_.offset[1]};
  }
  facts_.height_decimals = axes_[2].decimals;
}

LasReader::LasReader(std::string path, const PointChoice& choice, const PointPart& part)
    : path_(std::move(path)), returns_(choice.returns) {
  file_ = std::make_unique<LasFile>(path_);
  header_ = read_las_header(*file_);
  if (const auto hidden = hidden_las14(*file_, header_)) {
    hidden_ = std::make_unique<HiddenLas14>(*hidden);
  }
  is_old_ = header_.point_format < 6 && !hidden_;
  open_part(part);
  read_declarations();
  for (const int c : choice.classes) {
    if (c < 0 || c > 255) {
      throw Error(ErrorCode::invalid_argument,
                  "there is no class " + std::to_string(c) + "; LAS has classes 0 to 255", path_);
    }
    classes_.set(static_cast<std::size_t>(c));
  }
  if (choice.classes.empty()) {
    classes_.set();
  }
  names_classes_ = !choice.classes.empty();
  has_box_ = header_.low != header_.high;  // else nobody filled it in
  for (std::size_t i = 0; i < 3; ++i) {
    low_[i] = (header_.low[i] - header_.offset[i]) / header_.scale[i] - 1.0;
    high_[i] = (header_.high[i] - header_.offset[i]) / header_.scale[i] + 1.0;
  }
  set_lattice();
}

LasReader::~LasReader() = default;

void LasReader::open_part(const PointPart& part) {
  begin_ = std::min(part.begin, header_.points);
  end_ = std::clamp(part.end, begin_, header_.points);
  step_ = header_.record_bytes;
  if (header_.is_compressed) {
    laz::CompressedPoints points = compressed_points(*file_, header_, hidden_ != nullptr);
    step_ = points.layout.given_bytes();
    compressed_ = std::make_unique<laz::CompressedRecords>(std::move(points), begin_, end_);
    begin_ = compressed_->begin();
    end_ = compressed_->end();
  }
  read_ = begin_;
}

/// Reads the next records; there are some.
void LasReader::read_records() {
  if (compressed_) {
    compressed_->next(buffer_);
  } else {
    const std::uint64_t count =
        std::min(std::max<std::uint64_t>(kBatchBytes / step_, 1), end_ - read_);
    buffer_.resize(count * step_);
    file_->read(header_.first_point + read_ * step_, buffer_);
  }
  if (hidden_) {
    show_las14(*hidden_, step_,
               compressed_ ? laz::kRecordBytes : las_format_bytes(header_.point_format), buffer_);
  }
}

/// Reads what the records declare, and warns of a header that does not fit its file.
void LasReader::read_declarations() {
  DeclaredCrs declared = declared_by_las(*file_, header_);
  facts_.crs = std::move(declared.crs);
  facts_.vertical_crs = std::move(declared.vertical_crs);
  facts_.units = std::move(declared.units);
  for (SourceWarning& warning : declared.warnings) {
    warning.file = path_;
    warnings_.add(std::move(warning));
  }
  if (header_.returns_are_made_up && returns_ != ReturnChoice::kAll) {
    warn("las_returns",
         "its header says that return numbers were not measured; --returns goes by them all the "
         "same");
  }
  check_counts();
}

/// Warns of a header that counts otherwise than the file holds.
void LasReader::check_counts() {
  if (header_.minor_version >= 4 && header_.legacy_points != 0 &&
      header_.legacy_points != header_.points) {
    warn("las_counts", "its header counts " + std::to_string(header_.points) + " points, and " +
                           std::to_string(header_.legacy_points) +
                           " for programs of older versions; the former are read");
  }
  if (compressed_) {
    if (compressed_->chunks_behind() > 0) {
      warn("las_counts",
           "behind the " + std::to_string(header_.points) +
               " points that its header counts there are more chunks of points, which "
               "are not read; was it written to its end?");
    }
    return;
  }
  const std::uint64_t points_end = header_.first_point + header_.points * header_.record_bytes;
  std::uint64_t end = file_->bytes();
  for (const std::uint64_t begin :
       {header_.extended_records > 0 ? header_.first_extended : 0, header_.first_waveform}) {
    end = begin >= points_end ? std::min(end, begin) : end;
  }
  if (end >= points_end + header_.record_bytes) {
    warn("las_counts", "behind the " + std::to_string(header_.points) +
                           " points that its header counts there is room for " +
                           std::to_string((end - points_end) / header_.record_bytes) +
                           " more, which are not read; was it written to its end?");
  }
}

void LasReader::warn(const char* kind, std::string message) {
  warnings_.add({kind, std::move(message), path_});
}

std::uint64_t LasReader::most_parts() const noexcept {
  return compressed_ ? compressed_->chunks() : PointStream::most_parts();
}

SourceWarnings LasReader::warnings() const {
  SourceWarnings all = warnings_;
  const auto add = [&](const char* kind, const char* message, const OddPoints& odd) {
    if (odd.count > 0) {
      all.add({.kind = kind,
               .message = message,
               .file = path_,
               .count = odd.count,
               .point = odd.first});
    }
  };
  add("las_noise",
      "a point is of class 7 or 18, noise, and is built from all the same; --class '!noise' leaves "
      "such points out",
      noise_);
  add("las_box",
      "a point lies outside of the box that the header says all points are in; it is "
      "taken",
      out_of_box_);
  add("las_returns",
      "the number of an echo is 0 or more than its pulse has; it counts as the last "
      "one, and 0 as the first one, too",
      odd_returns_);
  return all;
}

/// The class. Formats 0 to 5 hold flags and class in one byte, formats 6 to 10 in two.
int LasReader::class_of(const unsigned char* record) const noexcept {
  return is_old_ ? record[15] & 0x1f : record[16];
}

/// Counts a point that is not withheld. In formats 0 to 5 overlap is a class, else a flag.
void LasReader::count_class(const unsigned char* record) {
  const int cls = class_of(record);
  ++counted_.points[static_cast<std::size_t>(cls)];
  counted_.overlap += is_old_ ? cls == kOverlapClass : (record[15] & 0x08) != 0;
}

/// Counts what there is to be warned of in a point that is handed out; points count from 1.
void LasReader::look_at(const unsigned char* record, std::uint64_t point) {
  const int cls = class_of(record);
  noise_.add(!names_classes_ && (cls == 7 || (cls == 18 && !is_old_)), point);
  if (returns_ != ReturnChoice::kAll) {
    const int number = record[14] & (is_old_ ? 0x07 : 0x0f);
    const int count = is_old_ ? (record[14] >> 3) & 0x07 : record[14] >> 4;
    odd_returns_.add(number == 0 || number > count, point);
  }
  if (has_box_) {
    const std::span<const unsigned char> bytes(record, 12);
    bool is_out = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto steps = static_cast<double>(las_value<std::int32_t>(bytes, 4 * i));
      is_out = is_out || steps < low_[i] || steps > high_[i];
    }
    out_of_box_.add(is_out, point);
  }
}

/// True for an echo that is wanted. Formats 0 to 5 hold its number and how many its pulse has in
/// three bits each, formats 6 to 10 in four; numbers count from 1, and 0 says nothing.
bool LasReader::is_wanted_return(const unsigned char* record) const {
  const int number = record[14] & (is_old_ ? 0x07 : 0x0f);
  const int count = is_old_ ? (record[14] >> 3) & 0x07 : record[14] >> 4;
  switch (returns_) {
    case ReturnChoice::kAll:
      return true;
    case ReturnChoice::kFirst:
      return number <= 1;
    case ReturnChoice::kLast:
      break;
  }
  return number == 0 || number >= count;
}

/// Why a point is left out: it is withheld, or of a class or a return that is not kept. One that is not
/// withheld is counted.
std::optional<LeftOutReason> LasReader::why_unwanted(const unsigned char* record) {
  if ((record[15] & (is_old_ ? 0x80 : 0x04)) != 0) {
    return LeftOutReason::kWithheld;
  }
  count_class(record);
  if (!classes_.test(static_cast<std::size_t>(class_of(record)))) {
    return LeftOutReason::kClass;
  }
  return is_wanted_return(record) ? std::nullopt : std::optional(LeftOutReason::kReturn);
}

bool LasReader::next(std::vector<SourcePoint>& batch) {
  batch.clear();
  while (batch.empty() && read_ < end_) {
    read_records();
    const std::uint64_t count = buffer_.size() / step_;
    for (std::uint64_t i = 0; i < count; ++i) {
      const unsigned char* record = buffer_.data() + i * step_;
      if (const auto reason = why_unwanted(record)) {
        left_out_.add(*reason);
        continue;
      }
      look_at(record, read_ + i + 1);
      const std::span<const unsigned char> bytes(record, 12);
      batch.push_back({axes_[0].decimal(las_value<std::int32_t>(bytes, 0)),
                       axes_[1].decimal(las_value<std::int32_t>(bytes, 4)),
                       axes_[2].decimal(las_value<std::int32_t>(bytes, 8))});
    }
    read_ += count;
  }
  return !batch.empty();
}

}  // namespace ptin
