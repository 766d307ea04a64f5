// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/level_stars.h"

namespace ptin {

template <class Page>
void LevelStars::read_from(const Page& page, const StarFilter& filter, QueryContext& context) {
  living_.clear();
  stars_.clear();
  if (filter.with_ties) {
    context.cost.records_examined += store_->read_stars(page, filter, stars_, context.cost.io);
    context.cost.stars_read += stars_.size();
    ties_.note_fans(stars_);
  } else {
    context.cost.records_examined += store_->read_living(page, filter, living_, context.cost.io);
    context.cost.stars_read += living_.stars.size();
  }
}

template void LevelStars::read_from(const PageId&, const StarFilter&, QueryContext&);
template void LevelStars::read_from(const DirectoryPage&, const StarFilter&, QueryContext&);

}  // namespace ptin
