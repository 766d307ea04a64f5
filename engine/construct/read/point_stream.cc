// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/point_stream.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <cpl_vsi.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/las_reader.h"
#include "engine/construct/read/ogr_points.h"
#include "engine/construct/read/tin_soup.h"
#include "engine/construct/read/xyz_reader.h"
#include "engine/construct/tin/tin_vertices.h"
#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::size_t kBatchPoints = 4096;
constexpr std::string_view kPacked = ".gz";

std::string lower_case(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

bool is_las(const std::string& path) {
  const std::string name = lower_case(path);
  return name.ends_with(".las") || name.ends_with(".laz");
}

bool is_text(const std::string& path) {
  std::string name = lower_case(path);
  if (is_packed(path)) {
    name.resize(name.size() - kPacked.size());
  }
  return name.ends_with(".csv") || name.ends_with(".xyz") || name.ends_with(".txt") ||
         name.ends_with(".tsv");
}

/// Text, in batches.
class TextPoints final : public PointStream {
 public:
  explicit TextPoints(const std::string& path) : reader_(path) {
    const GdalSession session;
    VSIStatBufL status;
    if (!is_packed(path) && VSIStatL(path.c_str(), &status) == 0) {
      total_ = static_cast<std::uint64_t>(status.st_size);
    }
  }
  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override {
    batch.clear();
    SourcePoint point;
    while (batch.size() < kBatchPoints && reader_.next(point)) {
      batch.push_back(point);
    }
    return !batch.empty();
  }
  [[nodiscard]] std::uint64_t done() const noexcept override { return reader_.bytes_read(); }
  [[nodiscard]] std::uint64_t total() const noexcept override { return total_; }

 private:
  XyzReader reader_;
  PointStreamFacts facts_;
  std::uint64_t total_ = 0;
};

}  // namespace

bool is_point_file(const std::string& path) { return is_las(path) || is_text(path); }

bool is_point_text(const std::string& path) { return is_text(path); }

bool is_packed(const std::string& path) { return lower_case(path).ends_with(kPacked); }

bool is_point_input(const std::string& path, const PointChoice& choice) {
  return is_point_file(path) || is_tin_file(path) || !choice.layer.empty() ||
         !choice.z_field.empty() || OgrPoints::reads(path);
}

std::unique_ptr<PointStream> open_point_stream(const std::string& path, const PointChoice& choice,
                                               std::optional<double> nodata,
                                               const StreamResources& resources) {
  const bool ogr = !choice.layer.empty() || !choice.z_field.empty();
  if (!choice.classes.empty() && (ogr || !is_las(path))) {
    throw Error(ErrorCode::invalid_argument,
                "only LAS has classes; leave the choice of classes out, or build LAS files alone",
                path);
  }
  if (is_tin_file(path)) {
    return std::make_unique<TinVertices>(path, choice, nodata, resources);
  }
  if (is_las(path)) {
    if (ogr) {
      throw Error(ErrorCode::invalid_argument,
                  "LAS has no layers and attributes; leave --layer and --z-field out", path);
    }
    return std::make_unique<LasReader>(path, choice);
  }
  if (is_text(path) && !ogr) {
    return std::make_unique<TextPoints>(path);
  }
  return std::make_unique<OgrPoints>(path, choice);
}

}  // namespace ptin
