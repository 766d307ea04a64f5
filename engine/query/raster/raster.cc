// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/error.h"
#include "engine/query/living/floor_cells.h"
#include "engine/query/living/living_place.h"
#include "engine/query/living/triangle_at.h"
#include "engine/query/raster/floor_pixels.h"
#include "engine/query/raster/pixel_centres.h"
#include "engine/query/raster/pixel_normals.h"
#include "engine/query/raster/pixel_sampler.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/shape/tiler.h"

namespace ptin {

namespace {

/// With more records of the level for each pixel of a rectangle, pixels are located one by one: a
/// pixel reads a few pages, and a page of the level has some hundred records.
constexpr double kRecordsOfPixel = 128;
/// Pixels located together: few enough to tell of progress now and then.
constexpr std::uint64_t kLocatedTogether = 4096;
/// Pixels of a raster's full TIN that are sampled together where there are several blocks: they come by
/// tiles, which are read more than once along the sides of what is sampled alone, and this many stay in a
/// processor's cache.
constexpr std::int64_t kOfFloorTogether = std::int64_t{1} << 19;
constexpr std::int64_t kMostSide = INT32_MAX;

void check(const std::string& file, const RasterRequest& request) {
  for (const double number : {request.lattice.origin.x, request.lattice.origin.y,
                              request.lattice.step_x, request.lattice.step_y}) {
    if (!std::isfinite(number)) {
      refuse("the raster's origin or step is not a finite number: give map units", file);
    }
  }
  if (request.lattice.step_x == 0 || request.lattice.step_y == 0) {
    refuse("the raster's step is 0: give the distance between the centres of pixels, map units",
           file);
  }
  const PixelRect& p = request.pixels;
  if (p.width < 1 || p.height < 1 || p.width > kMostSide || p.height > kMostSide) {
    refuse("the raster has " + std::to_string(p.width) + " x " + std::to_string(p.height) +
               " pixels: give from 1 to 2^31 - 1 columns and rows",
           file);
  }
  constexpr std::int64_t kMostIndex = std::int64_t{1} << 53;  // beyond it centres fall together
  if (std::max(p.column, p.row) > kMostIndex || std::min(p.column, p.row) < -kMostIndex) {
    refuse("the raster begins at column " + std::to_string(p.column) + " and row " +
               std::to_string(p.row) + ": give numbers from -2^53 to 2^53",
           file);
  }
  if (request.block_width < 1 || request.block_height < 1) {
    refuse("a block of the raster has no pixel: give sides of at least 1", file);
  }
  if (!(request.lattice.margin.x >= 0 && request.lattice.margin.y >= 0)) {
    refuse("the raster's margin is negative or not a number: give map units >= 0", file);
  }
  if (!(request.most_error >= 0)) {
    refuse("the raster's greatest error is negative or not a number: give height's units >= 0",
           file);
  }
  if (request.as_fine_as_pixels && (request.detail.tolerance || request.detail.vertices)) {
    refuse("both a level of detail and one as fine as the pixels are asked for: ask for one", file);
  }
}

/// The window of the map around all centres, and half a step beside them.
Window window_of(const PixelLattice& lattice, const PixelRect& p) {
  const MapPoint a = lattice.centre(p.column, p.row);
  const MapPoint b = lattice.centre(p.column + p.width - 1, p.row + p.height - 1);
  const double x = std::abs(lattice.step_x) / 2;
  const double y = std::abs(lattice.step_y) / 2;
  return {std::min(a.x, b.x) - x, std::min(a.y, b.y) - y, std::max(a.x, b.x) + x,
          std::max(a.y, b.y) + y};
}

DetailRequest detail_of(const OpenedTerrain& terrain, const RasterRequest& request,
                        QueryContext& context) {
  if (!request.as_fine_as_pixels) return request.detail;
  return detail_for(terrain.store(), static_cast<std::uint64_t>(request.pixels.pixels()),
                    window_of(request.lattice, request.pixels), context.cost.io,
                    request.most_error);
}

/// Reads one raster, rectangle by rectangle. Threads: one.
class RasterReading {
 public:
  RasterReading(const OpenedTerrain& terrain, const RasterRequest& request)
      : terrain_(terrain),
        facts_(terrain.store().facts()),
        request_((check(terrain.store().path(), request), request)),
        context_(request.limits, terrain.store().path()),
        asked_(detail_of(terrain, request, context_)),
        detail_(asked_, terrain.record_source(), context_),
        reader_(terrain, detail_),
        floor_(floor_for(terrain, detail_)) {}

  void hand_over(const RasterReceiver& receive) {
    const PixelRect& p = request_.pixels;
    const auto blocks = [](std::int64_t pixels, std::int64_t side) {
      return (pixels - 1) / side + 1;
    };
    const PixelRect all{0, 0, blocks(p.width, request_.block_width),
                        blocks(p.height, request_.block_height)};
    work_in_parts(all, [&](const PixelRect& some) { return hand_over(some, receive); });
  }

  /// Samples some rows at a time, so that a stop is heard within a fraction of a second and progress
  /// is told.
  void fill(std::span<double> heights, std::span<PointState> states) {
    constexpr std::int64_t kPixelsTogether = std::int64_t{1} << 22;
    PixelRect rows = request_.pixels;
    const std::int64_t end = rows.row + rows.height;
    const std::int64_t most_rows = std::max<std::int64_t>(1, kPixelsTogether / rows.width);
    for (; rows.row < end; rows.row += most_rows) {
      rows.height = std::min(most_rows, end - rows.row);
      const auto first = static_cast<std::size_t>((rows.row - request_.pixels.row) * rows.width);
      const auto count = static_cast<std::size_t>(rows.pixels());
      context_.check_stop();
      sample(rows, {heights.subspan(first, count),
                    states.empty() ? states : states.subspan(first, count)});
      tell_progress(rows.pixels());
    }
  }

  RasterResult result() {
    terrain_.store().pages().check_unchanged();
    const Certificate& certificate = detail_.certificate();
    return {asked_,          certificate.error, certificate.deviation, detail_.is_exact(facts_),
            surface_pixels_, context_.cost};
  }

 private:
  [[nodiscard]] bool hand_over(const PixelRect& blocks, const RasterReceiver& receive);
  void emit(const PixelRect& one, const PixelRect& sampled, const RasterReceiver& receive);
  [[nodiscard]] PixelRect pixels_of(const PixelRect& blocks) const;
  [[nodiscard]] std::uint64_t bytes_of(const PixelRect& pixels) const;

  void sample(const PixelRect& pixels, PixelBuffers<double> buffers);
  [[nodiscard]] bool is_sparse(const PixelCentres& centres) const;
  void locate(const PixelCentres& centres, PixelBuffers<double> buffers);
  [[nodiscard]] bool sample_normals(const PixelRect& part, const PixelRect& sampled);
  void tell_progress(std::int64_t more_pixels);
  template <class Pixels, class IsSurface>
  void count_surface(const Pixels& pixels, const IsSurface& is_surface) {
    surface_pixels_ +=
        static_cast<std::uint64_t>(std::count_if(pixels.begin(), pixels.end(), is_surface));
  }
  /// What a centre lies on is told by whether it has a height.
  [[nodiscard]] bool asks_surface() const noexcept { return request_.heights || request_.states; }

  const OpenedTerrain& terrain_;
  const StoreFacts& facts_;
  const RasterRequest& request_;
  QueryContext context_;
  DetailRequest asked_;
  Detail detail_;
  LivingReader reader_;
  const Floor* const floor_;  ///< The heights of the full TIN of a raster; else null.
  std::vector<double> heights_;
  std::vector<PointState> states_;
  std::vector<GridNormal> normals_;
  std::uint64_t surface_pixels_ = 0;
  std::int64_t pixels_done_ = 0;
};

/// Pixels of a rectangle of blocks, without those beyond the raster.
PixelRect RasterReading::pixels_of(const PixelRect& blocks) const {
  const PixelRect& all = request_.pixels;
  const std::int64_t column = blocks.column * request_.block_width;
  const std::int64_t row = blocks.row * request_.block_height;
  return {all.column + column, all.row + row,
          std::min(blocks.width * request_.block_width, all.width - column),
          std::min(blocks.height * request_.block_height, all.height - row)};
}

std::uint64_t RasterReading::bytes_of(const PixelRect& pixels) const {
  const std::uint64_t bytes_of_pixel = (asks_surface() ? sizeof(double) : 0) +
                                       (request_.states ? sizeof(PointState) : 0) +
                                       (request_.normals ? sizeof(GridNormal) : 0);
  // There may be 2^62 pixels. What is beyond all memory stays so when it is doubled.
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max() / 2;
  const auto count = static_cast<std::uint64_t>(pixels.pixels());
  return count > kMost / std::max<std::uint64_t>(bytes_of_pixel, 1) ? kMost
                                                                    : count * bytes_of_pixel;
}

/// Samples a rectangle of blocks together, unless the memory does not hold it.
bool RasterReading::hand_over(const PixelRect& blocks, const RasterReceiver& receive) {
  const PixelRect pixels = pixels_of(blocks);
  context_.hold(0);
  if (blocks.pixels() > 1 && !context_.fits(2 * bytes_of(pixels))) return false;
  if (blocks.pixels() > 1 && floor_ != nullptr && pixels.pixels() > kOfFloorTogether) return false;
  context_.hold(bytes_of(pixels));
  const auto count = static_cast<std::size_t>(pixels.pixels());
  if (asks_surface()) {
    heights_.resize(count);
    states_.resize(request_.states ? count : 0);
    sample(pixels, {heights_, states_});
  }
  if (request_.normals) {
    normals_.assign(count, {});
    work_in_parts(pixels, [&](const PixelRect& part) { return sample_normals(part, pixels); });
    if (!asks_surface()) count_surface(normals_, [](const GridNormal& n) { return n.z > 0; });
  }
  // Blocks come in the order in which halving reaches them, however many are sampled together.
  work_in_parts(blocks, [&](const PixelRect& some) {
    if (some.pixels() == 1) emit(some, pixels, receive);
    return some.pixels() == 1;
  });
  return true;
}

void RasterReading::emit(const PixelRect& one, const PixelRect& sampled,
                         const RasterReceiver& receive) {
  RasterBlock block;
  block.pixels = pixels_of(one);
  block.stride = static_cast<std::size_t>(sampled.width);
  const auto first = static_cast<std::size_t>((block.pixels.row - sampled.row) * sampled.width +
                                              block.pixels.column - sampled.column);
  if (request_.heights) block.heights = heights_.data() + first;
  if (request_.states) block.states = states_.data() + first;
  if (request_.normals) block.normals = normals_.data() + first;
  context_.check_stop();
  receive(block);
  tell_progress(block.pixels.pixels());
}

void RasterReading::tell_progress(std::int64_t more_pixels) {
  pixels_done_ += more_pixels;
  if (request_.progress) {
    request_.progress(static_cast<double>(pixels_done_) /
                      static_cast<double>(request_.pixels.pixels()));
  }
}

void RasterReading::sample(const PixelRect& pixels, PixelBuffers<double> buffers) {
  const PixelCentres centres(facts_, request_.lattice, pixels);
  PixelSampler<double> sampler(facts_, centres, buffers);
  if (meets(centres.box(), facts_.bounds)) {
    if (floor_ != nullptr && are_on_floor(floor_->facts().shape, centres)) {
      copy_floor(
          *floor_, facts_.heights, centres, buffers,
          [this] {
            tell_progress(0);
            context_.check_stop();
          },
          context_.cost);
    } else if (is_sparse(centres)) {
      locate(centres, buffers);
    } else {
      VisitorOf sampling(
          [&](std::size_t /*most_triangles*/) {
            tell_progress(0);
            return true;
          },
          [&](const LivingTriangle& t) { sampler.add(t); });
      LivingPlace place;
      place.box = centres.box();
      reader_.read(place, context_, sampling);
    }
  }
  count_surface(buffers.heights, [](double height) { return !std::isnan(height); });
}

/// Whether the pixels are few for the level's records around them, were these spread evenly.
bool RasterReading::is_sparse(const PixelCentres& centres) const {
  const auto area = [](const GridBox& b) {
    return (static_cast<double>(b.max_x) - b.min_x + 1) *
           (static_cast<double>(b.max_y) - b.min_y + 1);
  };
  const double share = std::min(1.0, area(centres.box()) / area(facts_.bounds));
  const double records =
      static_cast<double>(records_above(terrain_.store(), detail_.tolerance())) * share;
  return records > kRecordsOfPixel * static_cast<double>(centres.width()) *
                       static_cast<double>(centres.height());
}

/// Samples each pixel by itself. The answering triangle gives the height that all give.
void RasterReading::locate(const PixelCentres& centres, PixelBuffers<double> buffers) {
  std::vector<Spot> spots;
  std::vector<std::size_t> places;
  std::vector<TriangleAt> found;
  constexpr std::uint64_t kBytes = sizeof(Spot) + sizeof(std::size_t) + sizeof(TriangleAt);
  const std::uint64_t together =
      std::clamp<std::uint64_t>(context_.left_beside(0) / 4 / kBytes, 1, kLocatedTogether);
  const auto ask = [&] {
    found.assign(spots.size(), {});
    find_triangles(terrain_, detail_, spots, found, spots.size() * kBytes, context_);
    for (std::size_t i = 0; i < spots.size(); ++i) {
      if (!found[i].is_found) continue;
      const LivingTriangle& t = found[i].triangle;
      if (!buffers.states.empty()) {
        buffers.states[places[i]] = t.is_void ? PointState::kVoid : PointState::kSurface;
      }
      if (t.is_void) continue;
      const double code = codes_in(t, facts_.heights, spots[i]).mean();
      buffers.heights[places[i]] = facts_.heights.height_of_code(code);
    }
    spots.clear();
    places.clear();
    tell_progress(0);
  };
  for (std::size_t row = 0; row < centres.height(); ++row) {
    for (std::size_t column = 0; column < centres.width(); ++column) {
      const Spot spot = centres.spot(column, row);
      if (!contains(facts_.bounds, spot)) continue;
      spots.push_back(spot);
      places.push_back(row * centres.width() + column);
      if (spots.size() == together) ask();
    }
  }
  if (!spots.empty()) ask();
}

/// Sums up the normals of a part of what is sampled, unless the memory does not hold its triangles.
bool RasterReading::sample_normals(const PixelRect& part, const PixelRect& sampled) {
  const PixelCentres centres(facts_, request_.lattice, part);
  if (!meets(centres.box(), facts_.bounds)) return true;
  PixelNormals normals(facts_, centres);
  const std::uint64_t most_bytes = context_.left_beside(0);
  VisitorOf gathering(
      [&](std::size_t most_triangles) {
        tell_progress(0);
        return normals.bytes_with(most_triangles) <= most_bytes;
      },
      [&](const LivingTriangle& t) { normals.add(t); });
  LivingPlace place;
  place.box = centres.box();
  if (!reader_.read(place, context_, gathering)) {
    if (part.pixels() == 1) {
      throw Error(ErrorCode::resource_exhausted,
                  "the triangles that meet a single pixel take more memory than is left beside "
                  "the pixels: give more memory",
                  context_.file());
    }
    return false;
  }
  const auto first = static_cast<std::size_t>((part.row - sampled.row) * sampled.width +
                                              part.column - sampled.column);
  normals.sum_up(std::span(normals_).subspan(first), static_cast<std::size_t>(sampled.width));
  return true;
}

}  // namespace

RasterResult raster(const OpenedTerrain& terrain, const RasterRequest& request,
                    const RasterReceiver& receive) {
  return timed([&] {
    RasterReading reading(terrain, request);
    reading.hand_over(receive);
    return reading.result();
  });
}

RasterResult raster(const OpenedTerrain& terrain, const RasterRequest& request,
                    std::span<double> heights, std::span<PointState> states) {
  return timed([&] {
    RasterReading reading(terrain, request);
    reading.fill(heights, states);
    return reading.result();
  });
}

}  // namespace ptin
