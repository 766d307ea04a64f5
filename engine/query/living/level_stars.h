// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a level of detail page by page, whether the level is one of error or a number of
// vertices.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/query/living/living_page.h"
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
  /// @param page    A PageId, or a page that the directory named.
  /// @param filter  Filter of the level of detail (set_level()).
  /// @throws Error corruption, io_error
  template <class Page>
  void read(const Page& page, const LivingFilter& filter, QueryContext& context) {
    living_.clear();
    const auto look = [&](const RecordPage& p) {
      context.cost.records_examined += p.records();
      take_living(p, filter, living_);
    };
    store_->look_at(page, std::ref(look), context.heights(), context.cost.io);
    context.cost.stars_read += living_.stars.size();
    ties_.note_fans(living_);
  }
  /// What was read of the page.
  [[nodiscard]] const LivingStars& living() const noexcept { return living_; }
  /// Calls visit(const LivingTriangle&) for triangles of T0, or of the page, whose box is wanted:
  /// wants(const GridBox&), and that are wanted: is_wanted(const LivingTriangle&). Those of which the
  /// level does not tell are set aside.
  template <class Wants, class IsWanted, class Visit>
  void visit_t0(const Wants& wants, const IsWanted& is_wanted, const Visit& visit) {
    visit_living(store_->t0(), detail_->level(), [&](const LivingTriangle& t) {
      if (wants(box_of(t)) && is_wanted(t) && !ties_.set_aside(t)) {
        visit(t);
      }
    });
  }
  template <class Wants, class IsWanted, class Visit>
  void visit_page(const Wants& wants, const IsWanted& is_wanted, const Visit& visit) {
    visit_living(living_, heights_, wants, [&](const LivingTriangle& t) {
      if (is_wanted(t) && !ties_.set_aside(t)) {
        visit(t);
      }
    });
  }
  /// The same where the box tells alone.
  template <class Wants, class Visit>
  void visit_t0(const Wants& wants, const Visit& visit) {
    visit_t0(
        wants, [](const LivingTriangle&) { return true; }, visit);
  }
  template <class Wants, class Visit>
  void visit_page(const Wants& wants, const Visit& visit) {
    visit_page(
        wants, [](const LivingTriangle&) { return true; }, visit);
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

  /// How many triangles were set aside; the bytes of them, and of what tells of them.
  [[nodiscard]] std::size_t count_aside() const noexcept { return ties_.count(); }
  [[nodiscard]] std::uint64_t bytes_aside() const noexcept { return ties_.bytes(); }

 private:
  const StoreFile* store_;
  const Detail* detail_;
  HeightEncoding heights_;
  LivingTies ties_;
  LivingStars living_;
};

}  // namespace ptin
