// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at points and along a line, and the highest point.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include <cpl_error.h>
#include <ogr_spatialref.h>

#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// Fewer points are located in less time than a thread takes to start.
constexpr std::size_t kFewPoints = 1000;

/// Takes positions of another CRS to the terrain's; x is to the east in both. One that has no place
/// there becomes NaN.
/// @throws Error invalid_argument  GDAL does not know the CRS; the terrain's CRS is unknown
/// @throws Error cancelled         a stop was requested
void take_to_terrain(std::span<MapPoint> points, const std::string& crs, const OpenTerrain& t,
                     const std::stop_token& stop) {
  constexpr std::size_t kBetweenLooks = 100'000;
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
  OGRSpatialReference from, to;
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (t.crs.wkt.empty() || to.SetFromUserInput(t.crs.wkt.c_str()) != OGRERR_NONE) {
    refuse("the CRS of the terrain is unknown, so no positions of another one can be taken to it");
  }
  if (from.SetFromUserInput(crs.c_str()) != OGRERR_NONE) {
    refuse("\"" + crs + "\" is no CRS that is known; give a code as EPSG:4326, or WKT", "crs");
  }
  const std::unique_ptr<OGRCoordinateTransformation> change(
      OGRCreateCoordinateTransformation(&from, &to));
  if (!change) refuse("no way is known from \"" + crs + "\" to the CRS of the terrain", "crs");
  std::vector<double> x, y;
  std::vector<int> is_done;
  for (std::size_t first = 0; first < points.size(); first += kBetweenLooks) {
    stop_if_asked(stop, "the question");
    const auto some = points.subspan(first, std::min(kBetweenLooks, points.size() - first));
    x.clear(), y.clear();
    for (const MapPoint& p : some) x.push_back(p.x), y.push_back(p.y);
    is_done.assign(some.size(), 0);
    change->Transform(static_cast<int>(some.size()), x.data(), y.data(), nullptr, is_done.data());
    for (std::size_t i = 0; i < some.size(); ++i) {
      some[i] = is_done[i] != 0 ? MapPoint{x[i], y[i]} : MapPoint{kNowhere, kNowhere};
    }
  }
}

/// False of a position that has NaN, as one that is missing has, or infinity.
bool is_place(const MapPoint& p) noexcept { return std::isfinite(p.x) && std::isfinite(p.y); }

/// What locate() has found at points, as arrays that NumPy owns.
struct HeightArrays {
  explicit HeightArrays(std::size_t size)
      : height(static_cast<py::ssize_t>(size)),
        low(static_cast<py::ssize_t>(size)),
        high(static_cast<py::ssize_t>(size)),
        state(static_cast<py::ssize_t>(size)) {}
  py::array_t<double> height, low, high;
  py::array_t<std::uint8_t> state;
};

/// Where the numbers of these arrays lie, to be filled without the GIL.
struct HeightPlaces {
  explicit HeightPlaces(HeightArrays& arrays)
      : height(arrays.height.mutable_data()),
        low(arrays.low.mutable_data()),
        high(arrays.high.mutable_data()),
        state(arrays.state.mutable_data()) {}
  void put(std::size_t i, const LocatedPoint& point) const noexcept {
    height[i] = point.height;
    low[i] = point.height_min;
    high[i] = point.height_max;
    state[i] = static_cast<std::uint8_t>(point.state);
  }
  double *height, *low, *high;
  std::uint8_t* state;
};

/// A position that is a tuple or a list of two numbers, as most single ones are; making an array of
/// it would take longer than the answer.
std::optional<MapPoint> single_position(const py::handle& xy) {
  if (!PyTuple_CheckExact(xy.ptr()) && !PyList_CheckExact(xy.ptr())) return std::nullopt;
  if (PySequence_Fast_GET_SIZE(xy.ptr()) != 2) return std::nullopt;
  std::array<double, 2> numbers{};
  for (std::size_t i = 0; i < 2; ++i) {
    PyObject* const number = PySequence_Fast_GET_ITEM(xy.ptr(), static_cast<py::ssize_t>(i));
    if (!PyFloat_Check(number) && !PyLong_Check(number)) return std::nullopt;
    numbers[i] = PyFloat_AsDouble(number);
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  }
  return MapPoint{numbers[0], numbers[1]};
}

py::tuple locate_one(const OpenTerrain& t, MapPoint at, const LocateRequest& request) {
  LocateResult found;
  {
    const Question question;
    const py::gil_scoped_release release;
    found = t.terrain.locate({&at, 1}, request);
  }
  const LocatedPoint& p = found.points.front();
  return py::make_tuple(p.height, p.height_min, p.height_max, static_cast<int>(p.state),
                        found.certified_error, found.certified_deviation, found.exact);
}

/// Heights at points, put where they belong. Of what is no place nothing is asked: it lies outside.
LocateResult locate_all(const OpenTerrain& t, std::span<const MapPoint> points,
                        const LocateRequest& request, const HeightPlaces& places) {
  std::vector<MapPoint> asked;
  const bool are_all = std::all_of(points.begin(), points.end(), is_place);
  if (!are_all) std::copy_if(points.begin(), points.end(), std::back_inserter(asked), is_place);
  LocateResult found =
      t.terrain.locate(are_all ? points : std::span<const MapPoint>(asked), request);
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    places.put(i, is_place(points[i]) ? found.points[next++] : LocatedPoint{});
  }
  found.points = {};
  return found;
}

py::tuple locate(const OpenTerrain& t, const py::object& xy, const Asked& asked,
                 const std::optional<std::string>& crs) {
  std::stop_source stop;
  LocateRequest request;
  asked.put(request, stop.get_token());
  const bool may_wait = t.is_remote || asked.vertices;
  const std::optional<MapPoint> single = single_position(xy);
  const bool is_quick = !crs && !may_wait;
  if (single && is_quick && is_place(*single)) return locate_one(t, *single, request);

  const Numbers numbers(xy);
  const std::span<const MapPoint> points = points_of(numbers);
  const bool is_scalar = numbers.ndim() == 1;
  if (is_scalar && is_quick && is_place(points.front())) {
    return locate_one(t, points.front(), request);
  }
  HeightArrays arrays(points.size());
  const HeightPlaces places(arrays);
  const auto work = [&] {
    if (!crs) return locate_all(t, points, request, places);
    std::vector<MapPoint> there(points.begin(), points.end());
    take_to_terrain(there, *crs, t, stop.get_token());
    return locate_all(t, there, request, places);
  };
  LocateResult found;
  if (points.size() < kFewPoints && !may_wait) {
    const Question question;
    const py::gil_scoped_release release;
    found = work();
  } else {
    found = answer(t, stop, work);
  }
  if (is_scalar) {
    return py::make_tuple(*places.height, *places.low, *places.high,
                          static_cast<int>(*places.state), found.certified_error,
                          found.certified_deviation, found.exact);
  }
  return py::make_tuple(arrays.height, arrays.low, arrays.high, arrays.state, found.certified_error,
                        found.certified_deviation, found.exact);
}

py::tuple profile(const OpenTerrain& t, const Numbers& line, std::optional<double> stations,
                  const Asked& asked) {
  std::stop_source stop;
  ProfileRequest request;
  asked.put(request, stop.get_token());
  const Ground ground = ground_of(t.crs);
  if (ground.geographic) {
    request.ground_distance = [&ground](MapPoint a, MapPoint b) {
      return ground.distance(a, b) * ground.metres_per_height;
    };
  }
  if (stations) request.station_step = *stations;
  const std::span<const MapPoint> points = points_of(line);
  std::vector<double> distance, xy, height;
  std::vector<std::uint8_t> state;
  std::vector<std::uint8_t> is_station;
  const ProfileResult found = answer(t, stop, [&] {
    ProfileResult walked = t.terrain.profile(points, request);
    for (const ProfilePoint& p : walked.points) {
      distance.push_back(p.distance);
      xy.insert(xy.end(), {p.position.x, p.position.y});
      height.push_back(p.height);
      state.push_back(static_cast<std::uint8_t>(p.state));
      is_station.push_back(p.is_station ? 1 : 0);
    }
    walked.points = {};
    return walked;
  });
  return py::make_tuple(array_of(std::move(distance)), table_of(std::move(xy), 2),
                        array_of(std::move(height)), array_of(std::move(state)),
                        array_of(std::move(is_station)), certificate_of(found));
}

py::tuple tuple_of(const HeightAt& at) {
  return py::make_tuple(at.position.x, at.position.y, at.height);
}

py::tuple highest(const OpenTerrain& t, const RegionArgument& region, bool lowest,
                  std::uint32_t listed, const Asked& asked) {
  std::stop_source stop;
  HighestRequest request;
  asked.put(request, stop.get_token());
  request.region = region_of(region);
  request.lowest = lowest;
  request.listed = listed;
  const HighestResult found = answer(t, stop, [&] { return t.terrain.highest(request); });
  std::vector<double> vertices;
  for (const HeightAt& at : found.vertices) {
    vertices.insert(vertices.end(), {at.position.x, at.position.y, at.height});
  }
  return py::make_tuple(name_of(found.state), tuple_of(found.point), found.at_vertex,
                        found.height_min, found.height_max, table_of(std::move(vertices), 3),
                        certificate_of(found));
}

}  // namespace

void add_heights(py::module_& module) {
  module.def("locate", locate);
  module.def("profile", profile);
  module.def("highest", highest);
}

}  // namespace ptin::python
