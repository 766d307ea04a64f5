// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at points and along a line, and the highest point.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "engine/crs/ground.h"
#include "engine/stop.h"
#include "tools/python/binding.h"
#include "tools/python/other_crs.h"

namespace ptin::python {

namespace {

/// Fewer points are located in less time than a thread takes to start.
constexpr std::size_t kFewPoints = 1000;

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

/// Heights at some points, put from `first` on. Of what is no place nothing is asked: it lies outside.
LocateResult locate_some(const OpenTerrain& t, std::span<const MapPoint> points,
                         const LocateRequest& request, const HeightPlaces& places,
                         std::size_t first) {
  std::vector<MapPoint> asked;
  const bool are_all = std::all_of(points.begin(), points.end(), is_place);
  if (!are_all) std::copy_if(points.begin(), points.end(), std::back_inserter(asked), is_place);
  LocateResult found =
      t.terrain.locate(are_all ? points : std::span<const MapPoint>(asked), request);
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    places.put(first + i, is_place(points[i]) ? found.points[next++] : LocatedPoint{});
  }
  found.points = {};
  return found;
}

/// Heights at all points. Millions are located in portions, as their sorting hears no stop. All portions
/// are of one level of detail, so the certificate of one is that of all.
LocateResult locate_all(const OpenTerrain& t, std::span<const MapPoint> points,
                        const LocateRequest& request, const HeightPlaces& places) {
  constexpr std::size_t kTogether = std::size_t{1} << 22;
  LocateResult found;
  std::size_t first = 0;
  do {
    stop_if_asked(request.limits.stop, "the question");
    const auto some = points.subspan(first, std::min(kTogether, points.size() - first));
    found = locate_some(t, some, request, places, first);
    first += kTogether;
  } while (first < points.size());
  return found;
}

py::tuple locate(const OpenTerrain& t, const py::object& xy, const Asked& asked,
                 const std::optional<std::string>& crs) {
  LocateRequest request;
  asked.put(request, {});  // one point is found before anybody could ask for a stop
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
  std::stop_source stop;
  request.limits.stop = stop.get_token();
  HeightArrays arrays(points.size());
  const HeightPlaces places(arrays);
  const auto work = [&] {
    if (!crs) return locate_all(t, points, request, places);
    std::vector<MapPoint> there(points.begin(), points.end());
    const OtherCrs other(*crs, t);
    // A stop is looked for so often that it is heard within a tenth of a second.
    constexpr std::size_t kBetweenLooks = 100'000;
    for (std::size_t first = 0; first < there.size(); first += kBetweenLooks) {
      stop_if_asked(stop.get_token(), "the question");
      other.take(std::span(there).subspan(first, std::min(kBetweenLooks, there.size() - first)));
    }
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
  // Where nothing was found, nothing bounds it.
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool is_found = found.state == PointState::kSurface;
  return py::make_tuple(name_of(found.state), tuple_of(found.point), found.at_vertex,
                        is_found ? found.height_min : kNone, is_found ? found.height_max : kNone,
                        table_of(std::move(vertices), 3), certificate_of(found));
}

}  // namespace

void add_heights(py::module_& module) {
  module.def("locate", locate);
  module.def("profile", profile);
  module.def("highest", highest);
}

}  // namespace ptin::python
