// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrain: the one face of engine/query. All questions that can be asked of a file, for the
// program, a service and bindings: plain requests in, plain results out.
//
// | question                   | function        | request             | header                   |
// |----------------------------|-----------------|---------------------|--------------------------|
// | mesh at a level of detail  | refine          | RefineRequest       | refine/refine.h          |
// | the same, in parts         | parts           | PartRequest         | living/tin_parts.h       |
// | mesh that follows a region | moving_window   | MovingWindowOptions | refine/moving_window.h   |
// | heights at points          | locate          | LocateRequest       | heights/locate.h         |
// | heights along lines        | profile         | ProfileRequest      | heights/profile.h        |
// | heights at pixels          | raster          | RasterRequest       | raster/raster.h          |
// | the same, on no lattice    | heights_at      | LocateRequest       | raster/scattered_pixels.h|
// | highest or lowest point    | highest         | HighestRequest      | heights/highest.h        |
// | what became void, surface  | class_changes   | ClassChangesRequest | heights/class_changes.h  |
// | is a line of sight free    | sight           | SightRequest        | sight/sight.h            |
// | the same of many pairs     | sight_lines     | SightRequest        | sight/sight.h            |
// | what an observer sees      | viewshed        | ViewshedRequest     | sight/viewshed.h         |
// | volumes, cut and fill      | volume, volumes | VolumeRequest       | volume/volume.h          |
// | contours                   | isolines        | IsolineRequest      | isoline/isoline.h        |
// | the file, coarse to fine   | stream          | StreamRequest       | stream/stream_writer.h   |
// | do the records fit         | check_hierarchy | HierarchyRequest    | refine/hierarchy_check.h |
//
// A request holds a DetailRequest (which TIN: the full one, one within an error, or the most
// important vertices; select/detail.h) and QueryLimits (memory and stop token;
// select/query_limits.h). Two requests differ. A StreamRequest names what is wanted by a predicate.
// A MovingWindow gets its predicate and its stop token with each move. Every result states what it
// is certified for and what it cost.
//
// This header declares requests and results alone. Who asks a question includes its header too, and
// who asks many questions.h. An empty request, {}, is about the full TIN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/select/opened_terrain.h"

namespace ptin {

enum class PointState : std::uint8_t;
struct ClassChanges;
struct ClassChangesRequest;
struct DetailRequest;
struct HierarchyReport;
struct HierarchyRequest;
struct HighestRequest;
struct HighestResult;
struct IsolineRequest;
struct LocateRequest;
struct LocateResult;
struct MovingWindowOptions;
struct PartRequest;
struct ProfileRequest;
struct ProfileResult;
struct RasterBlock;
struct RasterRequest;
struct RasterResult;
struct RefineRequest;
struct RefinedTin;
struct SightPair;
struct SightRequest;
struct SightResult;
struct StreamRequest;
struct StreamSummary;
struct Viewshed;
struct ViewshedRequest;
struct VolumeRequest;
struct VolumeResult;
class Isolines;
class MovingWindow;
class SightSolver;
class TinParts;

/// How points, lines of sight and isolines are found. The answers are the same.
enum class AnswerBy : std::uint8_t {
  /// From heights where they can be, else from stars. A terrain with another index in use answers by
  /// splits.
  kBest,
  /// The full TIN from the heights of a raster, where the file has them (OpenedTerrain::floor()).
  kHeights,
  /// From the triangles that live at the level and meet the place (engine/DESIGN.md, section 6.15),
  /// found by the file's own index.
  kStars,
  /// As the paper has it (engine/query/paper): records are retrieved by the index in use, sorted
  /// topologically and applied to T0. A terrain with another index in use always answers so.
  kSplits,
};

/// A terrain on disk that answers questions. A copy shares the file and costs nothing.
/// Threads: all functions but use_index() are const and may be called at once. No question blocks
/// another, and each keeps to limits of its own.
///
/// Errors that every question may throw; the header of a question names further ones:
///   invalid_argument    a request that means nothing, or heights are to answer and cannot
///   resource_exhausted  the answer needs more memory than the limit; what the index shows is
///                       refused before pages are read, what results take while they grow
///   corruption          a page of the file is damaged, or the file changed since it was opened
///   io_error            the file cannot be read
///   cancelled           a stop was requested
class Terrain : public OpenedTerrain {
 public:
  using OpenedTerrain::OpenedTerrain;

  /// Opens the file at `path`.
  /// @throws Error as StoreFile::open; corruption when the stored T0 is not a valid TIN
  [[nodiscard]] static Terrain open(const std::string& path,
                                    PageAccess access = PageAccess::kMapped,
                                    ReplacedFile replaced = ReplacedFile::kRefused) {
    return Terrain(path, access, replaced);
  }

  /// The TIN at a level of detail, over the whole domain or in a region.
  [[nodiscard]] RefinedTin refine(const RefineRequest& request) const;
  /// The TIN at a level of detail, part by part, each part within the memory limit.
  [[nodiscard]] TinParts parts(PartRequest request) const;
  /// A mesh that begins as T0 and follows predicates. The window shares the file and may outlive
  /// the terrain.
  [[nodiscard]] MovingWindow moving_window(const MovingWindowOptions& options) const;

  /// Heights at points in map units: surface, void and outside told apart.
  [[nodiscard]] LocateResult locate(std::span<const MapPoint> points, const LocateRequest& request,
                                    AnswerBy by = AnswerBy::kBest) const;
  /// Heights along a polyline, with a break at every edge of the TIN.
  [[nodiscard]] ProfileResult profile(std::span<const MapPoint> line,
                                      const ProfileRequest& request) const;
  [[nodiscard]] ProfileResult profile(std::span<const std::vector<MapPoint>> lines,
                                      const ProfileRequest& request) const;
  /// Heights at the centres of pixels, block by block, or in the caller's memory.
  RasterResult raster(const RasterRequest& request,
                      const std::function<void(const RasterBlock&)>& receive) const;
  RasterResult raster(const RasterRequest& request, std::span<double> heights,
                      std::span<PointState> states = {}) const;
  /// Heights at the centres of pixels of another projection, close together.
  RasterResult heights_at(std::span<const MapPoint> centres, const LocateRequest& request,
                          std::span<double> heights) const;
  /// The highest or lowest point of the terrain or of a window.
  [[nodiscard]] HighestResult highest(const HighestRequest& request) const;
  /// Samples that a level of detail moves from surface to void, or back.
  [[nodiscard]] ClassChanges class_changes(const ClassChangesRequest& request) const;

  /// Whether the ends of a line see each other.
  [[nodiscard]] SightResult sight(const SightPair& pair, const SightRequest& request,
                                  AnswerBy by = AnswerBy::kBest) const;
  /// Sight lines of many pairs.
  /// @param coarse_records  As for the constructor of SightSolver; by splits there is no coarse level.
  [[nodiscard]] SightSolver sight_lines(const SightRequest& request, std::uint64_t coarse_records,
                                        AnswerBy by = AnswerBy::kBest) const;
  /// What one observer sees.
  [[nodiscard]] Viewshed viewshed(const ViewshedRequest& request) const;

  /// Isolines, joined over the whole terrain.
  [[nodiscard]] Isolines isolines(const IsolineRequest& request,
                                  AnswerBy by = AnswerBy::kBest) const;

  /// Cut, fill and net volume over or under a level, or between two terrains.
  [[nodiscard]] VolumeResult volume(const VolumeRequest& request) const;
  /// Volumes over or under several levels, in one pass.
  [[nodiscard]] std::vector<VolumeResult> volumes(const VolumeRequest& request,
                                                  std::span<const double> levels) const;

  /// Sends T0 and then splits, the most important ones first. StreamReader (stream/stream_reader.h)
  /// receives them.
  StreamSummary stream(const StreamRequest& request,
                       const std::function<void(std::span<const std::byte>)>& sink) const;

  /// Whether the records are closed and saturated, which every question stands on: what verify
  /// looks at beside verify_store().
  [[nodiscard]] HierarchyReport check_hierarchy(const HierarchyRequest& request) const;

 private:
  /// The file has one index of stars, so another index in use means records.
  [[nodiscard]] bool is_by_splits(AnswerBy by) const noexcept {
    return by == AnswerBy::kSplits || uses_other_index();
  }
  /// This terrain, with its heights in use where they may answer.
  /// @throws Error invalid_argument  heights are to answer, and the file has none, the level is not the
  ///                                 full TIN, or another index is in use
  [[nodiscard]] Terrain answering(AnswerBy by, const DetailRequest& detail) const;
};

}  // namespace ptin
