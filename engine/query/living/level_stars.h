// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a level of detail page by page, whether the level is one of error or a number of
// vertices.
#pragma once

#include <cstdint>

#include "engine/query/living/living_ties.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "storage/point_directory.h"
#include "storage/store_file.h"

namespace ptin {

/// Reads pages of stars, and hands out their triangles that live at a level: at once, but for those
/// of which the level's last error alone does not tell (LivingTies), which come at the end.
/// Threads: one owner.
class LevelStars {
 public:
  /// @param store, detail  Borrowed for the life of this object.
  LevelStars(const StoreFile& store, const Detail& detail)
      : store_(&store), detail_(&detail), heights_(store.facts().heights), ties_(detail) {}

  [[nodiscard]] const Detail& detail() const noexcept { return *detail_; }
  /// Begins a new search: forgets what was set aside.
  void clear() noexcept { ties_.clear(); }

  /// Reads what the filter asks for of a page, in the place of the page before.
  /// @param filter  Of the level of detail (set_level()).
  /// @throws Error corruption, io_error
  void read(PageId page, const StarFilter& filter, QueryContext& context) {
    read_from(page, filter, context);
  }
  /// The same of a page that the directory named.
  void read(const DirectoryPage& page, const StarFilter& filter, QueryContext& context) {
    read_from(page, filter, context);
  }
  /// Calls visit(const LivingTriangle&) for triangles of T0, or of the page, whose box is wanted:
  /// wants(const GridBox&). Those of which the level does not tell are set aside.
  template <class Wants, class Visit>
  void visit_t0(const Wants& wants, const Visit& visit) {
    visit_living(store_->t0(), detail_->level(),
                 [&](const LivingTriangle& t) { take(t, wants, visit); });
  }
  template <class Wants, class Visit>
  void visit_page(const Wants& wants, const Visit& visit) {
    visit_living(living_, heights_, wants, visit);
    visit_living(stars_, *detail_, heights_,
                 [&](const LivingTriangle& t) { take(t, wants, visit); });
  }
  /// Calls visit(const LivingTriangle&) for each triangle set aside that lives, and forgets all.
  template <class Visit>
  void settle(const Visit& visit) {
    ties_.settle(visit);
  }
  /// Calls visit(const LivingTriangle&) for each triangle set aside, and forgets all.
  template <class Visit>
  void abandon(const Visit& visit) {
    ties_.abandon(visit);
  }

  /// Bytes of what was set aside, and of what tells of it.
  [[nodiscard]] std::uint64_t bytes_aside() const noexcept { return ties_.bytes(); }

 private:
  template <class Page>
  void read_from(const Page& page, const StarFilter& filter, QueryContext& context);
  template <class Wants, class Visit>
  void take(const LivingTriangle& t, const Wants& wants, const Visit& visit) {
    if (wants(box_of(t)) && !ties_.set_aside(t)) {
      visit(t);
    }
  }

  const StoreFile* store_;
  const Detail* detail_;
  HeightEncoding heights_;
  LivingTies ties_;
  LivingStars living_;
  StarredRecords stars_;  ///< Whole, where the level cuts between records of one error.
};

}  // namespace ptin
