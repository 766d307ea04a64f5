// SPDX-License-Identifier: GPL-3.0-or-later
//
// The isolines of a stream, kept up to date while it arrives (paper, section 5.2).
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tools/ptin/command.h"
#include "tools/ptin/isoline_layer.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

/// --level, --interval, --base, --window, --3d, --steps.
struct StreamIsolineOptions {
  ask::Levels levels;
  std::vector<double> window;
  bool z = false;
  bool steps = false;

  [[nodiscard]] bool given() const { return levels.given(); }
};
void add_stream_isolines(ask::Parameters& rows, StreamIsolineOptions& options);

/// Follows a StreamReader and writes the isolines of its mesh: once, of the mesh at the end, or
/// with --steps after T0 and after every frame of splits.
class StreamIsolines {
 public:
  /// @param options  Outlive this; their levels become heights in the stream's unit.
  /// @param reading  Of these options; settled when the stream tells its units.
  /// @param output  The layer; empty writes none.
  /// @param limits  Memory for the isolines that are kept and for writing them; the stop token.
  StreamIsolines(const StreamIsolineOptions& options, ask::Reading& reading, OutputOptions out,
                 QueryLimits limits);

  /// To be called after every StreamReader::feed_frame(). Cost: what the frame changed
  /// (engine/query/isoline/isoline_progressive.h), and with --steps all lines.
  void follow(const StreamReader& reader);
  /// Writes what is left to write, publishes the layer, and returns the object `isolines` of the
  /// answer.
  [[nodiscard]] nlohmann::json finish(const StreamReader& reader);

 private:
  void begin(const StreamReader& reader);
  void write(const StreamReader& reader);

  const StreamIsolineOptions& options_;
  ask::Reading& reading_;
  OutputOptions out_;
  std::optional<Window> window_;
  std::stop_token stop_;
  QueryContext context_;
  std::optional<ProgressiveIsolines> isolines_;
  /// Null without an output.
  std::unique_ptr<IsolineLayer> layer_;
  IsolineChange change_;         ///< The sum over all splits.
  std::uint64_t numbering_ = 0;  ///< The numbering of the mesh that isolines_ follow.
  IsolineLayer::Written last_;
  nlohmann::json steps_ = nlohmann::json::array();
};

}  // namespace ptin::tools
