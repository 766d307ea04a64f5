// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/tin_parts.h"

#include <utility>

#include "engine/error.h"
#include "engine/query/living/living_tin.h"
#include "engine/query/living/stars_in_region.h"
#include "engine/stop.h"

namespace ptin {

struct TinParts::Impl {
  Impl(const OpenedTerrain& of, PartRequest asked)
      : terrain(of),
        request(std::move(asked)),
        context(request.limits, of.store().path()),
        detail(request.detail, terrain.record_source(), context),
        living(terrain, detail) {
    if (request.region) {
      region.emplace(*request.region, of.store().facts().map);
      stars.emplace(&*region);
    }
  }

  OpenedTerrain terrain;
  PartRequest request;
  QueryContext context;
  Detail detail;
  std::optional<GridRegion> region;
  std::optional<StarsInRegion> stars;
  LivingTin living;
};

TinParts::TinParts(const OpenedTerrain& terrain, PartRequest request)
    : impl_(std::make_unique<Impl>(terrain, std::move(request))) {}
TinParts::~TinParts() = default;
TinParts::TinParts(TinParts&&) noexcept = default;
TinParts& TinParts::operator=(TinParts&&) noexcept = default;

Tin* TinParts::part(const GridBox& box) {
  LivingPlace place;
  place.box = box;
  place.stars = impl_->stars ? &*impl_->stars : nullptr;
  const bool fits = impl_->living.gather(place, impl_->request.limits.memory_bytes, impl_->context);
  impl_->terrain.store().pages().check_unchanged();
  return fits ? &impl_->living.tin() : nullptr;
}

Tin* TinParts::part_for(const GridCell& cell, const GridBox& box) {
  Tin* const found = part(box);
  if (found == nullptr && cell.level == 0) {
    throw Error(ErrorCode::resource_exhausted,
                "what meets a single position of the grid takes more memory than the " +
                    std::to_string(impl_->request.limits.memory_bytes) +
                    " bytes of a part: give more memory",
                impl_->terrain.store().path());
  }
  return found;
}

std::uint64_t TinParts::triangles() const noexcept {
  const StoreFile& store = impl_->terrain.store();
  return 2 * (records_above(store, impl_->detail.tolerance()) + store.t0().vertices.size());
}

const OpenedTerrain& TinParts::terrain() const noexcept { return impl_->terrain; }
const Detail& TinParts::detail() const noexcept { return impl_->detail; }
const PartRequest& TinParts::request() const noexcept { return impl_->request; }
const QueryCost& TinParts::cost() const noexcept { return impl_->context.cost; }

void walk_cells(TinParts& parts,
                const std::function<void(const GridCell& cell, Tin& part, double done)>& visit) {
  const StoreFile& store = parts.terrain().store();
  const QueryLimits& limits = parts.request().limits;
  work_on_cells(store.facts().bounds, [&](const GridCell& cell, double share, double done) {
    stop_if_asked(limits.stop, "the walk over the terrain", store.path());
    // A search of the index lists all pages: not worth it for cells that are far too large anyway.
    const auto expected =
        static_cast<std::uint64_t>(static_cast<double>(parts.triangles()) * share);
    const bool is_hopeless =
        cell.level > 0 && LivingTin::bytes_for(expected) / 16 > limits.memory_bytes;
    Tin* const part = is_hopeless ? nullptr : parts.part_for(cell, cell.box());
    if (part != nullptr) visit(cell, *part, done);
    return part != nullptr;
  });
}

}  // namespace ptin
