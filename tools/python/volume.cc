// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes over a level, or between two terrains.
#include <vector>

#include "engine/construct/process_limits.h"
#include "engine/crs/border_move.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// @throws Error invalid_argument  positions or heights of the two cannot be compared
void check_comparable(const CrsFacts& here, const CrsFacts& other) {
  if (!is_same_plane(here, other)) {
    refuse(
        "the CRS of the other terrain is not that of this one; transform the source of one and "
        "build it again",
        "against");
  }
  if (!here.vertical_name.empty() && !other.vertical_name.empty() &&
      here.vertical_text() != other.vertical_text()) {
    refuse(
        "the heights of the other terrain do not count from where those of this one do; transform "
        "the source of one and build it again",
        "against");
  }
}

/// Heights' units of `here` in one of the other's; one that is not known is taken to be the other's.
double height_scale(const CrsFacts& here, const CrsFacts& other) {
  if (here.vertical_unit == "unknown" || other.vertical_unit == "unknown") return 1.0;
  return ground_of(other).metres_per_height / ground_of(here).metres_per_height;
}

py::tuple tuple_of(const CertifiedVolume& v) { return py::make_tuple(v.value, v.low, v.high); }

py::tuple tuple_of(const VolumeResult& r) {
  return py::make_tuple(tuple_of(r.cut), tuple_of(r.fill), tuple_of(r.net), r.rounding,
                        r.mean_difference,
                        py::make_tuple(r.surface_area, r.cut_area, r.fill_area, r.void_area,
                                       r.only_here_area, r.only_other_area),
                        r.certificate.error, r.certificate.deviation, r.exact);
}

py::list volumes(const OpenTerrain& t, const std::vector<double>& levels, const OpenTerrain* other,
                 const RegionArgument& region, int threads, const Asked& asked) {
  std::stop_source stop;
  VolumeRequest request;
  asked.put(request, stop.get_token());
  request.region = region_of(region);
  CrsFacts crs = t.crs;
  if (other != nullptr) {
    check_comparable(crs, other->crs);
    request.other = &other->terrain;
    request.other_height_scale = height_scale(crs, other->crs);
    if (crs.vertical_unit == "unknown") crs.vertical_unit = other->crs.vertical_unit;
  }
  const Ground ground = ground_of(crs);
  request.ground = {ground.per_map_unit, !ground.geographic};
  // Borders move by metres where map units are degrees, and by map units elsewhere.
  const double ground_per_move =
      ground.geographic ? 1 / ground.metres_per_height : ground.per_map_unit({0, 0}).x;
  request.border_move = [ground_per_move](const StoreFile& store, double certified_error) {
    return ground_per_move * border_moved_at_most(store, certified_error);
  };
  request.threads = threads > 0 ? threads : allowed_threads();
  const std::stop_callback on_stop(stop.get_token(), [other] {
    if (other != nullptr) other->stop_waiting();
  });
  const std::vector<VolumeResult> found = answer(t, stop, [&] {
    return other != nullptr ? std::vector<VolumeResult>{t.terrain.volume(request)}
                            : t.terrain.volumes(request, levels);
  });
  py::list told;
  for (const VolumeResult& r : found) told.append(tuple_of(r));
  return told;
}

}  // namespace

void add_volumes(py::module_& module) { module.def("volumes", volumes); }

}  // namespace ptin::python
