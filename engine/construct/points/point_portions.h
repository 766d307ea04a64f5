// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the files of a source of points are cut into portions, each read by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_part.h"

namespace ptin {

/// A file, or a part of one. A plain value.
struct PointPortion {
  std::uint64_t input = 0;  ///< The number of the file among the inputs.
  PointPart part;
  std::uint64_t bytes = 1;  ///< Bytes of the part in the file, about: for progress.
};

/// How large portions are, at most; a file that cannot be begun in the middle is one portion.
struct PortionSizes {
  std::uint64_t text_bytes = std::uint64_t{16} << 20;
  std::uint64_t las_records = std::uint64_t{1} << 19;
  /// Records of LAZ; a portion has the chunks that begin among them. A few chunks make a portion, so
  /// that all threads end together.
  std::uint64_t laz_records = std::uint64_t{1} << 18;
};

/// True for a pipe, a socket or a device: what is read of it is gone.
[[nodiscard]] bool can_be_read_once_only(const std::string& path);

/// True where a source names a CRS, horizontal or vertical.
[[nodiscard]] inline bool declares_crs(const PointStreamFacts& facts) {
  return !facts.crs.empty() || !facts.vertical_crs.empty();
}

/// Refuses files that do not go together. Wants all files, in their order, but for those without a
/// point that declare no CRS.
class SourceAgreement {
 public:
  explicit SourceAgreement(const SourceOptions& options) : options_(&options) {}
  /// @throws Error invalid_argument  a file has another CRS or other units than the first one
  void add(const PointStreamFacts& facts, const std::string& path);
  [[nodiscard]] const std::string& crs() const noexcept { return crs_; }
  [[nodiscard]] const std::string& vertical_crs() const noexcept { return vertical_crs_; }
  [[nodiscard]] const DeclaredUnits& units() const noexcept { return units_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }  ///< The first one's.

 private:
  const SourceOptions* options_;
  bool has_first_ = false;
  std::string crs_, vertical_crs_, path_;  ///< Without CRSs where `a_srs` replaces them.
  DeclaredUnits units_;
};

/// Cuts all files, in their order. It depends on the files alone: LAS is cut by records, LAZ by
/// chunks, text that is a file of the system's by bytes; TINs, layers, packed text and pipes are read
/// as a whole.
/// Cost: opens each file, but for TINs and what can be read only once.
/// @throws Error as open_point_stream() and SourceAgreement
[[nodiscard]] std::vector<PointPortion> cut_into_portions(const std::vector<std::string>& inputs,
                                                          const SourceOptions& options,
                                                          const PortionSizes& sizes = {});

/// The file as a whole.
[[nodiscard]] PointPortion whole_portion(const std::vector<std::string>& inputs, std::size_t input);

}  // namespace ptin
