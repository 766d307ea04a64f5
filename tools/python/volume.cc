// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes over a level, or between two terrains.
#include <string>
#include <vector>

#include "engine/construct/process_limits.h"
#include "engine/error.h"
#include "tools/ask/volume_terms.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// @throws Error invalid_argument  positions or heights of the two cannot be compared
void check_comparable(const CrsFacts& here, const CrsFacts& other) {
  const std::string mismatch = ask::mismatch_of(here, other, "this one");
  if (!mismatch.empty()) refuse("the other terrain: " + mismatch, "against");
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
    // A unit that is not known is taken to be the other's.
    request.other_height_scale = ask::height_scale(crs, other->crs).value_or(1.0);
    if (crs.vertical_unit == "unknown") crs.vertical_unit = other->crs.vertical_unit;
  }
  ask::set_ground(request, crs);
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
