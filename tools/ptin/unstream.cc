// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin unstream: what arrived of a stream, as a mesh.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/crs/border_move.h"
#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "engine/stop.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/formats/mesh_writer.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/stream_isolines.h"
#include "tools/region/mesh_crs.h"
#include "tools/region/serving.h"
#include "tools/region/tin_mesh.h"

namespace ptin::tools {

namespace {

struct UnstreamOptions {
  std::vector<std::string> inputs;
  std::string output, memory;
  StreamIsolineOptions isolines;
  bool overwrite = false;
};

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File opened(const std::string& path) {
  if (path == "-") return {stdin, [](std::FILE*) { return 0; }};
  File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw system_error(errno, "cannot open", path);
  return file;
}

/// The metadata of the stream that is being read.  @throws Error corruption when it is no JSON
/// object
nlohmann::json metadata_of(const StreamReader& reader) {
  nlohmann::json json = nlohmann::json::parse(reader.metadata(), nullptr, false);
  if (!json.is_object()) {
    throw Error(ErrorCode::corruption,
                "the stream's metadata is no JSON object; `ptin stream` "
                "did not write it");
  }
  return json;
}

/// As border_move_json() of the store that the stream came from.
nlohmann::json border_move_of(const StreamReader& reader, double certified_error) {
  const nlohmann::json metadata = metadata_of(reader);
  const auto free_of_voids = metadata.find("free_of_voids");
  return number_or_null(border_move_told_by(
      metadata, free_of_voids != metadata.end() && *free_of_voids == true, certified_error));
}

/// What the sender was asked for, from the metadata.  @throws Error corruption  it is no request
Serving serving_in(const nlohmann::json& metadata) {
  const nlohmann::json request = metadata.value("request", nlohmann::json::object());
  try {
    return servings_of(nlohmann::json::array({request}).dump()).front();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::invalid_argument) throw;
  }
  throw Error(ErrorCode::corruption,
              "the request in the stream's metadata is none; `ptin stream` did not write it");
}

/// Reads streams one after the other, and keeps what each of them brought.
class Receiver {
 public:
  /// @param isolines  Borrowed; follows what arrives. May be null.
  Receiver(std::string name, StreamReaderOptions options, StreamIsolines* isolines)
      : reader_(std::move(name), std::move(options)), isolines_(isolines) {}

  void read(const std::string& path, const Context& context) {
    const File file = opened(path);
    std::vector<std::byte> buffer(std::size_t{1} << 20);
    bool begun = false;
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
      begun = true;
      stop_if_asked(context.stop, "receiving", path);
      for (std::span<const std::byte> rest(buffer.data(), n); !rest.empty();) {
        rest = rest.subspan(isolines_ != nullptr ? reader_.feed_frame(rest) : reader_.feed(rest));
        if (isolines_ != nullptr) isolines_->follow(reader_);
        within_ = !reader_.is_complete();
        if (!within_) note();
      }
    }
    if (std::ferror(file.get()) != 0) throw system_error(errno, "cannot read", path);
    if (!begun && !reader_.has_mesh() && path != "-")
      refuse("this is not a stream of ptin: it is empty", path);
    if (begun && within_ && reader_.has_mesh()) note();
    if (within_) reader_.begin_next();
  }

  [[nodiscard]] const StreamReader& reader() const { return reader_; }
  [[nodiscard]] const nlohmann::json& have() const { return have_; }
  [[nodiscard]] bool complete() const { return !within_ && reader_.has_mesh(); }
  /// The window and the levels that the certificate of the last stream holds for.
  [[nodiscard]] Serving certified_for() const {
    const Serving& last = servings_.back();
    return {last.window, std::nullopt, last.levels, std::nullopt};
  }
  /// True when the last stream came whole, and the streams without error and splits together hold
  /// all of `asked` as the source has it.
  [[nodiscard]] bool exact(const Serving& asked) const {
    std::vector<Serving> whole;
    std::copy_if(servings_.begin(), servings_.end(), std::back_inserter(whole),
                 [](const Serving& s) { return !s.error && !s.splits; });
    return complete() && reader_.facts().base_error == 0 && covers(whole, asked);
  }
  /// True when the streams brought all of `asked`, at whatever error.
  [[nodiscard]] bool holds(const Serving& asked) const { return covers(servings_, asked); }
  /// The same request with its window cut at the terrain's box; with that box where it has no
  /// window.
  [[nodiscard]] Serving within_terrain(Serving asked) const {
    const StoreFacts& facts = reader_.facts();
    const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
    const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
    if (asked.window.empty()) {
      asked.window = {low.x, low.y, high.x, high.y};
    } else {
      asked.window = {std::max(asked.window[0], low.x), std::max(asked.window[1], low.y),
                      std::min(asked.window[2], high.x), std::min(asked.window[3], high.y)};
    }
    return asked;
  }

 private:
  void note() {
    Serving serving = serving_in(metadata_of(reader_));
    if (!reader_.is_complete()) serving.splits = reader_.splits();
    have_.push_back(to_json(serving));
    servings_.push_back(std::move(serving));
  }

  StreamReader reader_;
  StreamIsolines* isolines_;
  nlohmann::json have_ = nlohmann::json::array();
  std::vector<Serving> servings_;  ///< have_, as Servings.
  bool within_ = true;             ///< The last stream has not ended.
};

/// The counts of the reader's mesh as those of a refinement, which holds no mesh itself.
RefinedTin counts_of(const StreamReader& reader) {
  const Tin& tin = reader.tin();
  RefinedTin refined;
  refined.vertices = tin.vertices.size();
  refined.triangles = tin.triangles.size();
  refined.void_vertices =
      static_cast<std::uint64_t>(std::count(tin.has_height.begin(), tin.has_height.end(), 0));
  refined.t0_vertices = reader.t0_vertices();
  refined.certified_error = reader.certificate().error;
  refined.certified_deviation = reader.certificate().deviation;
  return refined;
}

/// Warns when more is asked for than was served: what lies beyond is whatever came along, and no
/// error bounds it.
void warn_of_what_is_beyond(const Receiver& receiver, const Serving& asked,
                            const Context& context) {
  if (context.quiet || receiver.holds(asked)) return;
  const Serving certified = receiver.certified_for();
  std::fprintf(stderr,
               "ptin: warning: the stream was asked for %s alone: what is beyond that is coarse, "
               "and nothing is certified there\n",
               certified.window.empty()   ? "some levels"
               : certified.levels.empty() ? "a window"
                                          : "some levels in a window");
}

nlohmann::json answer_of(const UnstreamOptions& options, const Receiver& receiver,
                         const RefinedTin& refined, const Mesh& mesh, const CrsFacts& crs,
                         const Serving& asked) {
  const StreamReader& reader = receiver.reader();
  const Serving certified = receiver.certified_for();
  return {{"output", options.output.empty() ? nlohmann::json() : nlohmann::json(options.output)},
          {"complete", receiver.complete()},
          {"splits", reader.splits()},
          {"splits_in_all", reader.splits_in_all()},
          {"vertices", refined.vertices},
          {"void_vertices", refined.void_vertices},
          {"triangles", refined.triangles},
          {"t0_vertices", refined.t0_vertices},
          {"written", {{"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}}},
          {"certified_error", refined.certified_error},
          {"certified_deviation", refined.certified_deviation},
          {"border_moved_at_most", border_move_of(reader, refined.certified_error)},
          {"certified_for", certified.given() ? to_json(certified) : nlohmann::json()},
          {"exact", receiver.exact(asked)},
          {"units", units_json(crs)},
          {"bytes_used", reader.bytes_used()},
          {"have", receiver.have()}};
}

void print_report(const Receiver& receiver, const RefinedTin& refined) {
  const StreamReader& reader = receiver.reader();
  std::fprintf(stderr,
               "%s, %s; certified %s at every sample, %s at any point of "
               "what was asked for\n",
               counted(refined.vertices, "vertex", "vertices").c_str(),
               counted(refined.triangles, "triangle").c_str(),
               short_number(refined.certified_error).c_str(),
               short_number(refined.certified_deviation).c_str());
  if (!receiver.complete()) {
    std::fprintf(stderr,
                 "the stream was cut: %s of %s arrived; for the rest ask "
                 "`ptin stream FILE ... --have '%s'`\n",
                 grouped(reader.splits()).c_str(), counted(reader.splits_in_all(), "split").c_str(),
                 receiver.have().dump().c_str());
  }
}

/// Writes the isolines instead of the mesh.
int write_isolines(const UnstreamOptions& options, const Receiver& receiver,
                   StreamIsolines& isolines, const Context& context) {
  const nlohmann::json lines = isolines.finish(receiver.reader());
  const RefinedTin refined = counts_of(receiver.reader());
  const Serving asked =
      receiver.within_terrain({options.isolines.window, std::nullopt,
                               lines.at("levels").get<std::vector<double>>(), std::nullopt});
  warn_of_what_is_beyond(receiver, asked, context);
  if (context.json) {
    const CrsFacts crs = crs_facts_of(metadata_of(receiver.reader()));
    nlohmann::json answer = answer_of(options, receiver, refined, {}, crs, asked);
    answer.erase("written");
    answer["isolines"] = lines;
    print_json(answer);
  } else if (!context.quiet) {
    print_report(receiver, refined);
    std::fprintf(stderr, "%s at %s, kept up to date over %s\n",
                 counted(lines.at("lines"), "isoline").c_str(),
                 counted(lines.at("levels").size(), "level").c_str(),
                 counted(lines.at("changed").at("splits"), "split").c_str());
  }
  return kExitDone;
}

void check_options(const UnstreamOptions& options, bool json) {
  if (!options.isolines.given()) {
    if (options.isolines.steps || options.isolines.z || !options.isolines.window.empty()) {
      throw Error(ErrorCode::invalid_argument,
                  "--steps, --window and --3d are for isolines; give --level H... or --interval D");
    }
    if (!options.output.empty()) static_cast<void>(mesh_format_of(options.output));
  } else if (!options.output.empty()) {
    static_cast<void>(isoline_format_of(options.output));
    if (options.isolines.steps) check_isoline_fields(options.output, "--steps");
    if (options.output == "-" && json) {
      throw Error(ErrorCode::invalid_argument,
                  "--json and -o - both write to stdout; give the isolines a file name");
    }
  }
  if (!options.output.empty() && options.output != "-") {
    check_output(options.output, options.overwrite);
  }
}

int run_unstream(const UnstreamOptions& options, const Context& context) {
  check_options(options, context.json);
  const std::uint64_t memory = memory_limit_of(options.memory);
  std::optional<StreamIsolines> isolines;
  if (options.isolines.given()) {
    isolines.emplace(options.isolines, options.output, options.overwrite,
                     QueryLimits{memory / 2, context.stop});
  }
  std::string name = options.inputs.size() == 1 ? options.inputs.front() : "streams";
  // Half of the memory is for what arrives, half for what is written of it.
  Receiver receiver(name == "-" ? "stdin" : std::move(name),
                    StreamReaderOptions{{memory / 2, context.stop}},
                    isolines ? &*isolines : nullptr);
  for (const std::string& input : options.inputs) receiver.read(input, context);
  if (!receiver.reader().has_mesh()) {
    throw Error(ErrorCode::corruption,
                "the stream ends before T0: nothing of it can be shown; get more of it");
  }
  if (isolines) return write_isolines(options, receiver, *isolines, context);
  RefinedTin refined = counts_of(receiver.reader());
  refined.tin = receiver.reader().tin();
  Mesh mesh = surface_mesh(refined, receiver.reader().facts());
  const CrsFacts crs = crs_facts_of(metadata_of(receiver.reader()));
  set_crs(mesh, crs, receiver.reader().facts());
  if (!options.output.empty()) write_mesh(mesh, options.output, options.overwrite);
  const Serving everywhere = receiver.within_terrain({});
  if (!options.output.empty()) warn_of_what_is_beyond(receiver, everywhere, context);
  const bool tells_frame = !options.output.empty() && has_frame(options.output);
  if (context.json) {
    nlohmann::json answer = answer_of(options, receiver, refined, mesh, crs, everywhere);
    if (tells_frame) answer["local_frame"] = frame_json(mesh.frame);
    print_json(answer);
  } else if (!context.quiet) {
    print_report(receiver, refined);
    if (tells_frame) std::fprintf(stderr, "frame: %s\n", frame_text(mesh.frame).c_str());
  }
  return kExitDone;
}

}  // namespace

Action declare_unstream(CLI::App& app, Context& context) {
  const auto options = std::make_shared<UnstreamOptions>();
  app.add_option("IN", options->inputs, "Streams, one after the other; - for stdin")->required();
  app.add_option(
         "-o,--output", options->output,
         "The mesh to write, or with --level or --interval the layer of isolines; its extension "
         "chooses the format. None: only tell what arrived")
      ->type_name("OUT");
  add_stream_isoline_options(app, options->isolines);
  add_memory_option(app, options->memory);
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_unstream(*options, context); };
}

}  // namespace ptin::tools
