// SPDX-License-Identifier: GPL-3.0-or-later
//
// Breaklines and a boundary, for `verify --against`. Put on the grid and joined here, by the rules
// that engine/construct/lines/line_noding.h states and by other code.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/geometry/point.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// The options that the metadata of a store says it was built with; an empty object where it does not.
[[nodiscard]] nlohmann::json options_of_build(const StoreFile& store);

/// The files of lines that a terrain was built with.
struct LineInputs {
  std::vector<std::string> breaklines;
  std::string boundary;
  [[nodiscard]] bool is_empty() const { return breaklines.empty() && boundary.empty(); }
};

/// A straight piece of a line: an edge of the full TIN, or a chain of edges.
struct LinePiece {
  GridPoint a, b;
  bool breakline = false, boundary = false;
};

class LineSamples {
 public:
  LineSamples() = default;
  /// @param resolution  As of grid_position().
  /// @throws Error  not_found, io_error, cancelled; invalid_argument where the store was built with
  ///                other files of lines than these, or without, or a file holds no lines
  LineSamples(const LineInputs& inputs, const StoreFile& store, std::optional<double> resolution,
              const std::stop_token& stop);

  [[nodiscard]] bool is_empty() const { return pieces_.empty() && !has_boundary_ && !is_flat_; }
  /// The vertices of lines that are samples, with their heights as the file stores them.
  [[nodiscard]] const std::map<VertexKey, double>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<LinePiece>& pieces() const { return pieces_; }
  /// True unless there is a boundary, and the point lies outside of it; or so near to a boundary
  /// without heights that rounding to the grid decides.
  [[nodiscard]] bool holds(GridPoint p) const;
  [[nodiscard]] bool has_boundary() const { return has_boundary_; }
  /// The boundary has no heights: it divides inside from outside, and has no samples; or breaklines
  /// have none, which say nothing.
  [[nodiscard]] bool is_flat() const { return is_flat_; }
  /// Takes a sample along: it divides the pieces that it lies on, at its own height.
  void divide_at(GridPoint p);
  /// Divides pieces as was noted.
  void finish();

 private:
  void read(const std::string& path, const std::string& layer, bool is_boundary,
            const std::stop_token& stop);
  void add_vertex(VertexKey key, double height, bool keeps_lower);
  [[nodiscard]] bool touch(std::size_t number, GridPoint p);
  void cross(std::size_t one, std::size_t other);
  [[nodiscard]] bool join_once();
  void drop_outside();
  [[nodiscard]] std::size_t band_of(std::int64_t y) const;
  void sort_pieces();
  [[nodiscard]] bool is_beside_boundary(GridPoint p) const;
  void index_boundary();
  template <class Visit>
  void visit_at(GridPoint p, const Visit& visit) const;

  const StoreFacts* facts_ = nullptr;
  std::optional<double> resolution_;
  std::map<VertexKey, double> vertices_;
  std::vector<LinePiece> pieces_;  ///< Sorted by their least x.
  std::int64_t widest_ = 0;        ///< The largest width of a piece.
  bool has_boundary_ = false, is_flat_ = false, is_boundary_flat_ = false;
  std::vector<std::vector<LinePiece>> bands_;  ///< The boundary, by rows of the terrain.
  std::vector<std::pair<std::size_t, GridPoint>> divisions_;
};

}  // namespace ptin::tools
