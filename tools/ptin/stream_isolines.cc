// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/stream_isolines.h"

#include <utility>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "tools/region/on_terrain.h"

namespace ptin::tools {

void add_stream_isolines(ask::Parameters& rows, StreamIsolineOptions& options) {
  ask::add_levels(rows, options.levels, "Write isolines at these heights instead of the mesh",
                  "The same at every multiple of D, from the base", ask::Door::kProgram);
  rows.add("window", &options.window, "XMIN YMIN XMAX YMAX", "Cut the isolines at a window")
      .in(ask::Unit::kMap)
      .values(4, 4);
  rows.add("3d", &options.z, "", "Points of isolines carry the height of their line");
  rows.add(
      "steps", &options.steps, "",
      "The isolines of T0 and after every frame, told apart by the fields step, splits and error");
}

StreamIsolines::StreamIsolines(const StreamIsolineOptions& options, ask::Reading& reading,
                               OutputOptions out, QueryLimits limits)
    : options_(options),
      reading_(reading),
      out_(std::move(out)),
      stop_(limits.stop),
      context_(std::move(limits), out_.output) {
  if (!options.window.empty()) window_ = window_of(options.window, "--window");
}

void StreamIsolines::follow(const StreamReader& reader) {
  if (!reader.has_mesh()) {
    return;
  }
  if (!isolines_) {
    begin(reader);
  } else if (reader.numbering() != numbering_) {
    isolines_->restart(reader.tin());
    numbering_ = reader.numbering();
    return;  // A further stream begins: the same mesh, numbered anew.
  } else {
    const IsolineChange change = isolines_->advance(reader.tin());
    if (change.splits == 0) {
      return;
    }
    change_.splits += change.splits, change_.triangles += change.triangles;
    change_.removed += change.removed, change_.added += change.added;
  }
  numbering_ = reader.numbering();
  if (options_.steps) {
    write(reader);
  }
}

void StreamIsolines::begin(const StreamReader& reader) {
  const StoreFacts& facts = reader.facts();
  if (window_) check_on_terrain(*window_, facts, "--window");
  const nlohmann::json metadata = nlohmann::json::parse(reader.metadata(), nullptr, false);
  const CrsFacts crs = metadata.is_object() ? crs_facts_of(metadata) : CrsFacts{};
  reading_.settle(crs);
  const std::vector<double> levels = ask::levels_of(options_.levels, facts);
  isolines_.emplace(reader.tin(), LevelSet(levels, facts.heights), facts.heights, facts.map,
                    context_);
  if (!out_.output.empty()) {
    const IndexLevels index{options_.levels.interval.value_or(0.0), options_.levels.base};
    layer_ = std::make_unique<IsolineLayer>(IsolineLayer::Options{
        out_.output, out_.overwrite, options_.z, options_.steps, crs, index, stop_});
  }
}

void StreamIsolines::write(const StreamReader& reader) {
  const Isolines lines = isolines_->lines(reader.tin(), context_);
  const ask::IsolineStep step{steps_.size(), reader.tin().vertices.size() - reader.t0_vertices(),
                              reader.certificate().error};
  last_ = {lines.size(), 0, lines.points()};
  if (layer_) {
    last_ = layer_->add(lines, step, window_);
  }
  steps_.push_back({{"splits", step.splits},
                    {"certified_error", step.certified_error},
                    {"lines", last_.lines},
                    {"points", last_.points}});
}

nlohmann::json StreamIsolines::finish(const StreamReader& reader) {
  if (!options_.steps) {
    write(reader);
  }
  if (layer_) {
    layer_->publish();
  }
  return {{"levels", isolines_->levels().heights()},
          {"lines", last_.lines},
          {"points", last_.points},
          {"steps", steps_},
          {"changed",
           {{"splits", change_.splits},
            {"triangles", change_.triangles},
            {"pieces_removed", change_.removed},
            {"pieces_added", change_.added}}}};
}

}  // namespace ptin::tools
