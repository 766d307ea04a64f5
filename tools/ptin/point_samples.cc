// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points for `verify --against`.
#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "engine/geometry/point.h"
#include "tools/ptin/source_samples.h"
#include "tools/ptin/text_samples.h"

namespace ptin::tools {

namespace {

/// What the reader of text takes: anything that is not known as LAS, a TIN or a layer.
bool is_text(const std::string& path) { return is_point_text(path) || !is_point_input(path, {}); }

class PointSamples final : public SourceSamples {
 public:
  PointSamples(const std::vector<std::string>& paths, const StoreFile& store)
      : heights_(store.facts().heights), choices_(choices_of(store)) {
    for (const std::string& path : paths) {
      if (is_text(path) && choices_.points.z_field.empty() && choices_.points.layer.empty()) {
        read_text(path, store.facts());
      } else {
        read_stream(path, store.facts());
      }
    }
    std::sort(samples_.begin(), samples_.end(),
              [](const Sample& a, const Sample& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    merge();
  }

  [[nodiscard]] SampleWindow read(const GridBox& box) override {
    SampleWindow window;
    window.box = box;
    const auto row = [](const Sample& s, std::int32_t y) { return s.y < y; };
    auto it = std::lower_bound(samples_.begin(), samples_.end(), box.min_y, row);
    for (; it != samples_.end() && it->y <= box.max_y; ++it) {
      if (it->x >= box.min_x && it->x <= box.max_x) window.samples.push_back(*it);
    }
    return window;
  }

 private:
  void read_text(const std::string& path, const StoreFacts& facts);
  void read_stream(const std::string& path, const StoreFacts& facts);
  void add(const std::array<double, 3>& p, const StoreFacts& facts, const std::string& where);
  void merge();
  /// Whole codes, so that sums are exact; heights where the store keeps floats.
  [[nodiscard]] double code_of(double height) const {
    return heights_.type == HeightType::int32
               ? std::nearbyint((height - heights_.offset) / heights_.step)
               : height;
  }
  [[nodiscard]] double rounded_mean(double sum, std::size_t count) const {
    const double mean = sum / static_cast<double>(count);
    return heights_.type == HeightType::int32 ? heights_.height_of_code(std::nearbyint(mean))
                                              : mean;
  }

  HeightEncoding heights_;
  SampleChoices choices_;
  std::vector<Sample> samples_;  ///< By y, then x.
};

void PointSamples::read_text(const std::string& path, const StoreFacts& facts) {
  TextSamples text(path);
  TextSamples::Line line;
  bool is_empty = true;
  while (text.next(line)) {
    const std::string where = path + ":" + std::to_string(line.number);
    is_empty = false;
    if (line.misfit.empty()) {
      add(line.point, facts, where);
    } else {
      misfits_.add(where + ": " + line.misfit);
    }
  }
  if (is_empty) {
    throw Error(ErrorCode::invalid_argument,
                "neither a raster that GDAL reads nor points as lines of x y z", path);
  }
}

void PointSamples::read_stream(const std::string& path, const StoreFacts& facts) {
  const auto stream = open_point_stream(path, choices_.points, choices_.nodata);
  std::vector<SourcePoint> batch;
  std::uint64_t number = 0;
  while (stream->next(batch)) {
    for (const SourcePoint& p : batch) {
      add({to_double(p.x), to_double(p.y), to_double(p.z)}, facts,
          path + ": point " + std::to_string(++number));
    }
  }
}

void PointSamples::add(const std::array<double, 3>& p, const StoreFacts& facts,
                       const std::string& where) {
  if (choices_.nodata && p[2] == *choices_.nodata) return;
  const MapPoint grid = facts.map.to_grid({p[0], p[1]});
  const auto x = std::llround(grid.x);
  const auto y = std::llround(grid.y);
  const GridBox& b = facts.bounds;
  if (x < b.min_x || x > b.max_x || y < b.min_y || y > b.max_y) {
    if (!choices_.bbox) misfits_.add(where + ": this point lies outside of the terrain");
    return;
  }
  samples_.push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), p[2], false});
}

/// Points on one grid point count as one, at their mean height, rounded as heights are stored, as
/// the builder documents.
void PointSamples::merge() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples_.size();) {
    std::size_t end = i;
    double sum = 0.0;
    while (end < samples_.size() && samples_[end].x == samples_[i].x &&
           samples_[end].y == samples_[i].y) {
      sum += code_of(samples_[end++].height);
    }
    samples_[kept] = samples_[i];
    if (end - i > 1) samples_[kept].height = rounded_mean(sum, end - i);
    ++kept;
    i = end;
  }
  samples_.resize(kept);
}

}  // namespace

std::unique_ptr<SourceSamples> open_point_samples(const std::vector<std::string>& paths,
                                                  const StoreFile& store) {
  return std::make_unique<PointSamples>(paths, store);
}

}  // namespace ptin::tools
