// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/store_output.h"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/check.h"
#include "engine/construct/build_option_table.h"
#include "engine/crs/crs_facts.h"
#include "storage/error_table.h"
#include "storage/file/file_questions.h"
#include "storage/packed_segment.h"

namespace ptin {

namespace {

GridBox bounds_of(const Tin& tin) {
  GridBox bounds;
  for (const Vertex& v : tin.vertices) {
    if (v.triangle != kNone) {
      bounds = united(bounds, v.position);
    }
  }
  return bounds;
}

/// Points by class, but for those that are withheld.
nlohmann::json classes_json(const PointClasses& counted) {
  nlohmann::json classes = nlohmann::json::object();
  for (std::size_t i = 0; i < counted.points.size(); ++i) {
    if (counted.points[i] > 0) {
      classes[std::to_string(i)] = counted.points[i];
    }
  }
  return classes;
}

nlohmann::json source_json(const std::vector<std::string>& inputs, const BuildReport& r) {
  nlohmann::json files = nlohmann::json::array();
  for (const std::string& input : inputs) {
    files.push_back(std::filesystem::path(input).filename().string());
  }
  nlohmann::json source = {
      {"files", files},
      {"samples", r.source_samples},
      {"void_samples", r.void_samples},
      {"lone_samples", r.lone_samples},
      {"left_out_points", r.left_out.total()},
      {"merged_points", r.merged_points},
      {"largest_shift", {{"plan", r.largest_shift_plan}, {"height", r.largest_shift_height}}},
      {"height_rounding", r.height_rounding}};
  if (r.classes.are_known()) {
    source["classes"] = classes_json(r.classes);
    source["overlap"] = r.classes.overlap;
    source["withheld"] = r.left_out.of(LeftOutReason::kWithheld);
  }
  return source;
}

/// What of a raster stands nowhere else in the file.
nlohmann::json raster_json(const KeptRaster& raster) {
  nlohmann::json json{{"geotransform", nullptr},
                      {"pixels", raster.is_point ? "points" : "areas"},
                      {"lost", nullptr}};
  if (raster.geotransform) json["geotransform"] = *raster.geotransform;
  if (!raster.lost.empty()) json["lost"] = raster.lost;
  return json;
}

}  // namespace

CoarsestTin coarsest_tin(const Tin& tin) {
  CoarsestTin t0;
  std::vector<std::uint32_t> place(tin.vertices.size(), kNone);
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    if (tin.vertices[v].triangle != kNone) {
      place[v] = static_cast<std::uint32_t>(t0.vertices.size());
      const bool has_height = tin.has_height[v] != 0;
      t0.vertices.push_back(
          {tin.position(v), has_height ? tin.vertices[v].height : 0, has_height ? 1U : 0U});
    }
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      const Triangle& triangle = tin.triangles[t];
      t0.triangles.push_back({{place[triangle.v[0]], place[triangle.v[1]], place[triangle.v[2]]},
                              tin.classes[t] == TriangleClass::kVoid ? 1U : 0U});
    }
  }
  return t0;
}

std::vector<float> coarsest_deaths(const Tin& tin, std::span<const float> deaths,
                                   const StoredDetail& detail) {
  PTIN_CHECK(deaths.size() == tin.triangles.size());
  std::vector<float> stored;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      stored.push_back(detail.death(deaths[t]));
    }
  }
  return stored;
}

namespace {

StoreWriterOptions writer_options(const BuildOptions& options, bool overwrite, FileLayer& files,
                                  const std::string& work_folder) {
  StoreWriterOptions result;
  result.overwrite = overwrite;
  result.page_bytes = options.page_bytes;
  result.files = &files;
  result.work_folder = work_folder;
  return result;
}

}  // namespace

StorePacker::StorePacker(const BuildOptions& options, const TerrainFrame& frame, bool is_raster,
                         FileLayer& files, std::string work_folder)
    : detail_{frame.height_rounding, options.max_error},
      heights_(frame.heights),
      // Flat parts that --max-error leaves out leave an error of 0 behind, but not each sample a vertex.
      form_{.has_floor = is_raster && options.max_error <= 0.0 && frame.height_rounding == 0.0},
      page_bytes_(options.page_bytes),
      files_(files),
      work_folder_(std::move(work_folder)) {}

PreparedSegment StorePacker::prepare(StarredRecords& records) const {
  detail_.add_rounding(records);
  // Of the source's TIN: before records are left out.
  const auto void_records = static_cast<std::uint64_t>(
      std::count_if(records.splits.begin(), records.splits.end(),
                    [](const VertexSplit& r) { return (r.flags & VertexSplit::kAnyVoid) != 0; }));
  const RecordBounds left_out = detail_.leave_out(records);
  return {pack_segment(records, heights_, form_, page_bytes_), left_out, void_records};
}

void StorePacker::place(std::span<const std::byte> pages, std::uint64_t offset) const {
  ScratchFile(files_, pages_file_in(work_folder_), ScratchFile::Kept::kExisting)
      .write_at(pages, offset);
}

StoreOutput::StoreOutput(const std::string& path, const BuildOptions& options, bool overwrite,
                         const TerrainFrame& frame, bool is_raster, FileLayer& files,
                         const std::string& work_folder)
    : path_(path),
      options_(options),
      frame_(frame),
      writer_(StoreWriter::create(path, writer_options(options, overwrite, files, work_folder))),
      packer_(options, frame, is_raster, files, work_folder),
      base_error_(frame.height_rounding),
      base_deviation_(frame.height_rounding) {}

void StoreOutput::add(const PreparedSegment& segment) {
  void_records_ += segment.void_records;
  base_error_ = std::max(base_error_, static_cast<double>(segment.left_out.error));
  base_deviation_ = std::max(base_deviation_, static_cast<double>(segment.left_out.deviation));
  writer_->add_placed(segment, frame_.heights);
}

std::uint64_t StoreOutput::page_bytes() const {
  return writer_->position().pages * options_.page_bytes;
}

nlohmann::json StoreOutput::position() const {
  const StoreCheckpoint end = writer_->position();
  // As bits: JSON knows no infinity.
  nlohmann::json errors = nlohmann::json::array();
  for (const ErrorBin& bin : end.errors) {
    errors.push_back({layout::to_bits(bin.upper), layout::to_bits(bin.max_deviation), bin.records,
                      bin.void_vertices});
  }
  return {{"pages", end.pages},
          {"chain", end.chain},
          {"errors", errors},
          {"rank", end.max_rank},
          {"void_records", void_records_},
          {"base_error", std::bit_cast<std::uint64_t>(base_error_)},
          {"base_deviation", std::bit_cast<std::uint64_t>(base_deviation_)}};
}

void StoreOutput::resume(const nlohmann::json& position) {
  StoreCheckpoint end{position.at("pages").get<std::uint64_t>(),
                      position.at("chain").get<std::uint64_t>(),
                      {},
                      position.at("rank").get<std::uint16_t>()};
  for (const nlohmann::json& bin : position.at("errors")) {
    end.errors.push_back({layout::to_float(bin.at(0).get<std::uint32_t>()),
                          layout::to_float(bin.at(1).get<std::uint32_t>()),
                          bin.at(2).get<std::uint64_t>(), bin.at(3).get<std::uint64_t>()});
  }
  writer_->resume(end, frame_.heights);
  void_records_ = position.at("void_records").get<std::uint64_t>();
  base_error_ = std::bit_cast<double>(position.at("base_error").get<std::uint64_t>());
  base_deviation_ = std::bit_cast<double>(position.at("base_deviation").get<std::uint64_t>());
}

void StoreOutput::add_floor(const std::function<KeptRaster(StoreWriter&)>& add) {
  if (packer_.form().has_floor) {
    PTIN_CHECK(base_error_ == 0.0);
    raster_ = add(*writer_);
  }
}

void StoreOutput::publish(const Tin& t0, std::span<const float> t0_deaths,
                          const std::vector<std::string>& inputs, BuildReport& report) {
  CoarsestTin coarsest = coarsest_tin(t0);
  const std::vector<float> deaths = coarsest_deaths(t0, t0_deaths, packer_.detail());
  PTIN_CHECK(deaths.size() == coarsest.triangles.size());
  for (std::size_t i = 0; i < deaths.size(); ++i) {
    coarsest.triangles[i].death = deaths[i];
  }
  StoreFacts facts;
  facts.map = frame_.map;
  facts.heights = frame_.heights;
  facts.bounds = bounds_of(t0);
  facts.min_height = frame_.min_height;
  facts.max_height = frame_.max_height;
  facts.base_error = base_error_;
  facts.base_deviation = base_deviation_;
  facts.source_samples = report.source_samples;
  facts.free_of_voids = void_records_ == 0 && !has_void(coarsest);
  facts.page_bytes = options_.page_bytes;
  nlohmann::json crs{{"wkt", frame_.crs_wkt}, {"vertical_known", frame_.vertical_crs_known}};
  if (nlohmann::json told = json_of(crs_facts(frame_.crs_wkt)); !told.is_null()) {
    crs["facts"] = std::move(told);
  }
  nlohmann::json source = source_json(inputs, report);
  if (raster_) source["raster"] = raster_json(*raster_);
  const nlohmann::json metadata{
      {"crs", std::move(crs)},
      {"units", {{"horizontal", frame_.horizontal_unit}, {"height", frame_.vertical_unit}}},
      {"height_quantum", frame_.height_quantum},
      {"options", options_json(options_)},
      {"source", std::move(source)}};
  writer_->publish(facts, coarsest,
                   metadata.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  const StoreCheckpoint end = writer_->position();
  report.records = records_in(end.errors);
  report.t0_vertices = coarsest.vertices.size();
  report.max_rank = end.max_rank;
  report.file_bytes = bytes_of_file(path_);
}

}  // namespace ptin
