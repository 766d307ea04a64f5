// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/store_output.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/check.h"
#include "engine/construct/build_option_table.h"
#include "engine/construct/scratch/plain_value.h"
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

nlohmann::json source_json(const std::vector<std::string>& inputs, const BuildReport& r) {
  nlohmann::json files = nlohmann::json::array();
  for (const std::string& input : inputs) {
    files.push_back(std::filesystem::path(input).filename().string());
  }
  return {{"files", files},
          {"samples", r.source_samples},
          {"void_samples", r.void_samples},
          {"lone_samples", r.lone_samples},
          {"left_out_points", r.left_out.total()},
          {"merged_points", r.merged_points},
          {"largest_shift", {{"plan", r.largest_shift_plan}, {"height", r.largest_shift_height}}},
          {"height_rounding", r.height_rounding}};
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

/// What the output must know of a segment; error bins and descriptors follow it in the bytes.
struct SegmentFacts {
  std::uint64_t records, void_records;
  std::uint64_t bins, descriptors;
  RecordBounds worst;  ///< Of what was left out.
  std::uint32_t max_rank;
  std::uint32_t reserved;
};

/// Takes plain values from the front of bytes.
template <PlainValue T>
std::vector<T> take(std::span<const std::byte>& bytes, std::uint64_t count) {
  PTIN_CHECK(count <= bytes.size() / sizeof(T));
  std::vector<T> values(static_cast<std::size_t>(count));
  const auto part = bytes.first(values.size() * sizeof(T));
  std::copy(part.begin(), part.end(), std::as_writable_bytes(std::span(values)).begin());
  bytes = bytes.subspan(part.size());
  return values;
}

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

StorePacker::StorePacker(const BuildOptions& options, const TerrainFrame& frame, FileLayer& files,
                         std::string work_folder)
    : detail_{frame.height_rounding, options.max_error},
      heights_(frame.heights),
      page_bytes_(options.page_bytes),
      files_(files),
      work_folder_(std::move(work_folder)) {}

PreparedSegment StorePacker::prepare(StarredRecords& records) const {
  detail_.add_rounding(records);
  SegmentFacts facts{};
  // Of the source's TIN: before records are left out.
  facts.void_records = static_cast<std::uint64_t>(
      std::count_if(records.splits.begin(), records.splits.end(),
                    [](const VertexSplit& r) { return (r.flags & VertexSplit::kAnyVoid) != 0; }));
  facts.worst = detail_.leave_out(records);
  PackedSegment packed = pack_segment(records, heights_, page_bytes_);
  const std::optional<PageCounts> counts = count_pages(packed.pages, packed.descriptors, heights_);
  PTIN_CHECK(counts.has_value());
  facts.records = counts->records;
  facts.max_rank = counts->max_rank;
  facts.bins = counts->bins.size();
  facts.descriptors = packed.descriptors.size();
  const std::array<std::span<const std::byte>, 3> parts{
      std::as_bytes(std::span(&facts, 1)), std::as_bytes(std::span(counts->bins)),
      std::as_bytes(std::span(packed.descriptors))};
  PreparedSegment prepared{
      std::move(packed.pages),
      std::vector<std::byte>(parts[0].size() + parts[1].size() + parts[2].size())};
  auto end = prepared.description.begin();
  for (const std::span<const std::byte> part : parts) {
    end = std::copy(part.begin(), part.end(), end);
  }
  return prepared;
}

void StorePacker::place(std::span<const std::byte> pages, std::uint64_t offset) const {
  ScratchFile(files_, pages_file_in(work_folder_), ScratchFile::Kept::kExisting)
      .write_at(pages, offset);
}

StoreOutput::StoreOutput(const std::string& path, const BuildOptions& options, bool overwrite,
                         const TerrainFrame& frame, FileLayer& files,
                         const std::string& work_folder)
    : path_(path),
      options_(options),
      frame_(frame),
      writer_(StoreWriter::create(path, writer_options(options, overwrite, files, work_folder))),
      packer_(options, frame, files, work_folder),
      base_error_(frame.height_rounding),
      base_deviation_(frame.height_rounding) {}

void StoreOutput::add(std::span<const std::byte> description) {
  const SegmentFacts facts = take<SegmentFacts>(description, 1)[0];
  PageCounts counts;
  counts.records = facts.records;
  counts.max_rank = static_cast<std::uint16_t>(facts.max_rank);
  counts.bins = take<ErrorBin>(description, facts.bins);
  const auto descriptors = take<layout::NodeEntry>(description, facts.descriptors);
  void_records_ += facts.void_records;
  base_error_ = std::max(base_error_, static_cast<double>(facts.worst.error));
  base_deviation_ = std::max(base_deviation_, static_cast<double>(facts.worst.deviation));
  max_rank_ = std::max(max_rank_, counts.max_rank);
  records_ += facts.records;
  writer_->add_placed(descriptors, counts, frame_.heights);
}

std::uint64_t StoreOutput::page_bytes() const {
  return writer_->position().pages * options_.page_bytes;
}

nlohmann::json StoreOutput::position() const {
  const StoreCheckpoint end = writer_->position();
  return {{"pages", end.pages},
          {"chain", end.chain},
          {"records", records_},
          {"rank", max_rank_},
          {"void_records", void_records_},
          // As bits: JSON knows no infinity.
          {"base_error", std::bit_cast<std::uint64_t>(base_error_)},
          {"base_deviation", std::bit_cast<std::uint64_t>(base_deviation_)}};
}

void StoreOutput::resume(const nlohmann::json& position) {
  writer_->resume(
      {position.at("pages").get<std::uint64_t>(), position.at("chain").get<std::uint64_t>()},
      frame_.heights);
  records_ = position.at("records").get<std::uint64_t>();
  max_rank_ = position.at("rank").get<std::uint16_t>();
  void_records_ = position.at("void_records").get<std::uint64_t>();
  base_error_ = std::bit_cast<double>(position.at("base_error").get<std::uint64_t>());
  base_deviation_ = std::bit_cast<double>(position.at("base_deviation").get<std::uint64_t>());
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
  const nlohmann::json metadata{
      {"crs", {{"wkt", frame_.crs_wkt}, {"vertical_known", frame_.vertical_crs_known}}},
      {"units", {{"horizontal", frame_.horizontal_unit}, {"height", frame_.vertical_unit}}},
      {"height_quantum", frame_.height_quantum},
      {"options", options_json(options_)},
      {"source", source_json(inputs, report)}};
  writer_->publish(facts, coarsest,
                   metadata.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  report.records = records_;
  report.t0_vertices = coarsest.vertices.size();
  report.max_rank = max_rank_;
  report.file_bytes = bytes_of_file(path_);
}

}  // namespace ptin
