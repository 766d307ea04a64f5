// SPDX-License-Identifier: GPL-3.0-or-later
//
// The questions that are measured, at seeded places of a terrain.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/crs/ground.h"
#include "engine/query/questions.h"

namespace ptin::tools {

enum class QuestionKind : std::uint8_t {
  kPoint,          ///< The height at one place.
  kSight,          ///< Whether two places see each other, 2 units of height above ground.
  kWindow10000th,  ///< The triangles of a window of 1/10 000 of the bounding box.
  kWindow400th,    ///< A window of 1/400.
  kWindow25th,     ///< A window of 1/25.
  kIsoline25th,    ///< The isoline of the height in the middle of a window of 1/25.
};
inline constexpr std::array kQuestionKinds = {
    QuestionKind::kPoint,       QuestionKind::kSight,      QuestionKind::kWindow10000th,
    QuestionKind::kWindow400th, QuestionKind::kWindow25th, QuestionKind::kIsoline25th};

/// "point", "sight line", "window 1/10000", "window 1/400", "window 1/25", "isoline 1/25".
[[nodiscard]] const char* name_of(QuestionKind kind) noexcept;

struct Question {
  QuestionKind kind = QuestionKind::kPoint;
  MapPoint at{}, to{};  ///< The place, or the middle of the window; of a sight line its ends.
  Window window{};      ///< Window of windows and isolines; within the terrain.
  double level = 0.0;   ///< Level of an isoline.
};

/// What an answer cost, and a number that tells different answers apart.
struct Answer {
  QueryCost cost;
  std::uint64_t digest = 0;
};

/// Makes questions: number i of a kind is the same for the same file and seed. Places lie evenly over
/// the hull of the terrain. Threads: const functions may be called at once.
class Questions {
 public:
  /// @param tolerance  As DetailRequest::tolerance, of every question.
  Questions(const StoreFile& store, std::uint64_t seed, std::optional<double> tolerance);

  /// Reads the disk for an isoline alone, whose level is the height of its place.
  /// @throws Error as Terrain::locate
  [[nodiscard]] Question make(QuestionKind kind, std::uint64_t number,
                              const Terrain& terrain) const;
  /// @throws Error as the question's function of Terrain
  [[nodiscard]] Answer ask(const Question& question, const Terrain& terrain,
                           const QueryLimits& limits) const;
  /// The bytes of the file that make an answer, in whole pages, one at least. By heights: its samples times
  /// the mean bytes of a sample; they are those of the cell of a point, of the box of a window, of the
  /// cells along a sight line. By stars: those it looked at, times the mean bytes of a record.
  [[nodiscard]] std::uint64_t least_bytes(const Question& question, const Answer& answer) const;
  /// The records that a window or a point asks for, as a search of an index takes it. Null for other
  /// kinds.
  [[nodiscard]] PredicatePtr predicate(const Question& question) const;

 private:
  [[nodiscard]] bool is_in_hull(double x, double y) const;
  [[nodiscard]] double samples_of(const Question& question) const;

  StoreFacts facts_;
  CoarsestTin t0_;
  Ground ground_;
  std::uint64_t seed_;
  DetailRequest detail_;
  double bytes_of_sample_ = 0.0, bytes_of_record_ = 0.0;
};

}  // namespace ptin::tools
