# SPDX-License-Identifier: GPL-3.0-or-later
"""The answers. Each ends with what is certain of it; heights and errors are in the height's unit."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Iterator, NamedTuple, Optional

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


class State(IntEnum):
    """What a point can lie on: ``Heights.state`` and ``Profile.state`` hold these numbers."""

    SURFACE = 0
    VOID = 1
    OUTSIDE = 2


class Transform(NamedTuple):
    """Where pixels lie: x = a * column + b * row + c, y = d * column + e * row + f, of outer corners.

    The order is that of rasterio and of affine.Affine, to which ``Affine(*transform)`` turns it.
    """

    a: float
    b: float
    c: float
    d: float
    e: float
    f: float

    def to_gdal(self) -> tuple[float, float, float, float, float, float]:
        """The same in GDAL's order.

        >>> Transform(30, 0, 500000, 0, -30, 4000000).to_gdal()
        (500000, 30, 0, 4000000, 0, -30)
        """
        return (self.c, self.a, self.b, self.f, self.d, self.e)


class Place(NamedTuple):
    """A place on the terrain: map units, and the height's unit."""

    x: float
    y: float
    height: float


class LinePlace(NamedTuple):
    """A place on a line of sight: map units; from its first end over ground, and the line's height there, both in
    the height's unit."""

    x: float
    y: float
    distance: float
    height: float


@dataclass(eq=False)
class Certified:
    """What every answer says of itself.

    Positions are those of the file: points of a source without a grid were rounded to them, by
    ``Report.largest_shift`` at most.

    Attributes:
        certified_error: How far the answer is off at an input sample, at most.
        certified_deviation: How far the answer is off at any point, at most.
        exact: Nothing was left out, and the file's finest TIN is its source.
    """

    certified_error: float
    certified_deviation: float
    exact: bool


# Fields stand in the order in which the extension module gives them: one point is asked for in microseconds.
@dataclass(eq=False)
class Heights:
    """Heights at points, from :meth:`Terrain.locate`. ``numpy.asarray(heights)`` is ``heights.z``.

    Of N points each is an array of shape (N,); of one point, (x, y), a number.

    Attributes:
        z: float64. Heights on the TIN that was asked; NaN where it has no surface.
        low: float64. The exact height is no lower, if the exact TIN is surface there.
        high: float64. The exact height is no higher, likewise.
        state: uint8. What is there: :class:`State`.
    """

    z: Any
    low: Any
    high: Any
    state: Any
    certified_error: float
    certified_deviation: float
    exact: bool

    def __array__(self, dtype: Any = None, copy: Any = None) -> npt.NDArray[Any]:
        z = np.asarray(self.z, dtype=dtype)
        return z.copy() if copy else z


@dataclass(eq=False)
class Profile(Certified):
    """Heights along a line, from :meth:`Terrain.profile`: ``distance, xy, z, state = profile``.

    A point stands at each vertex of the line and wherever it crosses an edge of the TIN; between two points the surface
    is straight.

    Attributes:
        distance: (N,) float64. From the beginning of the line, over ground: map units, in degrees metres
            (``Terrain.units["length"]``).
        xy: (N, 2) float64, map units.
        z: (N,) float64; NaN where no surface touches the line.
        state: (N,) uint8, :class:`State`: what the stretch that begins here runs over; of the last point, what the
            one before does.
        station: (N,) bool. The point is a station; all False without ``stations``.
    """

    distance: Floats
    xy: Floats
    z: Floats
    state: npt.NDArray[np.uint8]
    station: npt.NDArray[np.bool_]

    def __iter__(self) -> Iterator[Any]:
        return iter((self.distance, self.xy, self.z, self.state))


@dataclass(eq=False)
class Mesh(Certified):
    """A mesh, from :meth:`Terrain.refine` and :meth:`Terrain.parts`: ``vertices, faces = mesh``.

    Attributes:
        vertices: (N, 3) float64: x, y in map units, and the height.
        faces: (M, 3) int32. Rows of ``vertices``, counter-clockwise from above. Surface alone: voids are holes.
    """

    vertices: Floats
    faces: npt.NDArray[np.int32]

    def __iter__(self) -> Iterator[Any]:
        return iter((self.vertices, self.faces))


@dataclass(eq=False)
class Raster(Certified):
    """Heights at the centres of pixels, from :meth:`Terrain.raster`: ``array, transform, crs = raster``.

    Attributes:
        array: (rows, columns) float64, from the north; NaN where there is no surface.
        transform: :class:`Transform`.
        crs: As ``Terrain.crs``.
    """

    array: Floats
    transform: Transform
    crs: str

    def __iter__(self) -> Iterator[Any]:
        return iter((self.array, self.transform, self.crs))

    def to_xarray(self) -> Any:
        """A DataArray with the coordinates ``y`` and ``x`` of the centres of pixels. Needs xarray."""
        import xarray

        rows, columns = self.array.shape
        a, _, c, _, e, f = self.transform
        coords = {"y": f + e * (np.arange(rows) + 0.5), "x": c + a * (np.arange(columns) + 0.5)}
        return xarray.DataArray(self.array, coords, ("y", "x"), name="height", attrs={"crs": self.crs})


@dataclass(eq=False)
class Isolines(Certified):
    """Isolines, from :meth:`Terrain.isolines`. Higher ground lies to the right of each. Line ``i`` is
    ``coords[offsets[i]:offsets[i + 1]]``, as GeoArrow and ``shapely.from_ragged_array`` have lines. At the exact height
    of a vertex lines may touch themselves and each other there.

    Attributes:
        coords: (P, 2) float64, map units.
        offsets: (L + 1,) int64.
        level: (L,) float64. The height of each line; ascending.
        ring: (L,) bool. The line is closed: its last point is its first.
        crs: As ``Terrain.crs``.
    """

    coords: Floats
    offsets: npt.NDArray[np.int64]
    level: Floats
    ring: npt.NDArray[np.bool_]
    crs: str

    def __len__(self) -> int:
        return len(self.level)

    def lines(self) -> Iterator[Floats]:
        """The points of each line, (n, 2) float64; views of ``coords``."""
        for begin, end in zip(self.offsets[:-1], self.offsets[1:]):
            yield self.coords[begin:end]

    def to_shapely(self) -> Any:
        """An array of L shapely LineStrings. Needs shapely, 1.8 or newer."""
        import shapely

        if hasattr(shapely, "from_ragged_array"):
            return shapely.from_ragged_array(shapely.GeometryType.LINESTRING, self.coords, (self.offsets,))
        from shapely.geometry import LineString

        lines = np.empty(len(self), dtype=object)
        for i, line in enumerate(self.lines()):
            lines[i] = LineString(line)
        return lines

    def to_geopandas(self) -> Any:
        """A GeoDataFrame with the columns ``elev`` and ``ring``, as ``ptin isoline`` writes layers. Needs geopandas."""
        import geopandas

        return geopandas.GeoDataFrame(
            {"elev": self.level, "ring": self.ring}, geometry=self.to_shapely(), crs=self.crs or None
        )


@dataclass(eq=False)
class Highest(Certified):
    """The highest or lowest point, from :meth:`Terrain.highest`.

    Attributes:
        state: ``"surface"``; ``"outside"`` or ``"void"`` where there is no point.
        point: The highest point of the surface in the region; None where there is none.
        at_vertex: False: on the region's border.
        height_min: The source's highest is no lower; NaN where nothing was found.
        height_max: The source's highest is no higher, likewise.
        vertices: (K, 3) float64: x, y and height of the highest vertices, falling.
    """

    state: str
    point: Optional[Place]
    at_vertex: bool
    height_min: float
    height_max: float
    vertices: Floats


class Clearance(NamedTuple):
    """The least height of a line above ground, and where. The exact one lies between ``min`` and ``max``."""

    min: float
    max: float
    at: Optional[LinePlace]


@dataclass(eq=False)
class Sight:
    """A line of sight, from :meth:`Terrain.sight`. Distances are over ground, in the height's unit.

    Attributes:
        verdict: ``"visible"``, ``"hidden"`` or ``"undecided"``; ``"undefined"`` where heights are above ground and
            an end has none below it. The first two are certain.
        ends: The state of the ground below each end, as ``"surface"``.
        length: Length of the line.
        obstruction: Where the line first goes below ground; None unless hidden.
        clearance: Its least height above ground, ends included; NaN where none is known.
        void_length: Length of the line over voids; NaN where it is not known.
        fresnel_ratio: With ``frequency``: the least clearance over the radius of the first Fresnel zone.
        fresnel_at: Where that is.
        certified_deviation: What is not known of the surface where the line is undecided; 0: nothing.
        exact: All that is told holds of the source.
    """

    verdict: str
    ends: tuple[str, str]
    length: float
    obstruction: Optional[LinePlace]
    clearance: Clearance
    void_length: float
    fresnel_ratio: Optional[float]
    fresnel_at: Optional[LinePlace]
    certified_deviation: float
    exact: bool


@dataclass(eq=False)
class Viewshed(Certified):
    """What one observer sees, from :meth:`Terrain.viewshed`: ``array, transform, crs = viewshed``.

    Attributes:
        array: (rows, columns) uint8, from the north: 255 visible, 0 hidden, 128 no target; 192 seems visible and 64
            hidden, where the source may be otherwise.
        transform: :class:`Transform`.
        crs: As ``Terrain.crs``.
        eye_height: Height of the observer's eye, absolute.
        visible, hidden: Pixels, for certain.
        undecided: Pixels; at a level of detail.
    """

    array: npt.NDArray[np.uint8]
    transform: Transform
    crs: str
    eye_height: float
    visible: int
    hidden: int
    undecided: int

    def __iter__(self) -> Iterator[Any]:
        return iter((self.array, self.transform, self.crs))


class Bounded(NamedTuple):
    """A volume of the TIN that was asked; the source's lies between ``low`` and ``high``."""

    volume: float
    low: float
    high: float


class Areas(NamedTuple):
    """Areas of the plane, in squares of the ground's unit.

    ``surface``: where the difference is known. ``cut``, ``fill``: where it is above or below 0. ``void``: within the
    hull, and void. ``only_file``, ``only_against``: where one terrain is surface and the other is not.
    """

    surface: float
    cut: float
    fill: float
    void: float
    only_file: float
    only_against: float


@dataclass(eq=False)
class Volume(Certified):
    """Volumes, from :meth:`Terrain.volume`, in cubes of the ground's unit (``Terrain.units["ground"]``).

    Attributes:
        level: As asked; None against another terrain.
        cut: What lies above the level, or above the other terrain.
        fill: What is missing below.
        net: Cut less fill.
        rounding: How far rounding can have changed one of the three; it is in their bounds.
        mean_difference: Net volume by surface area, height's unit; NaN where there is no surface.
        area: :class:`Areas`.
    """

    level: Optional[float]
    cut: Bounded
    fill: Bounded
    net: Bounded
    rounding: float
    mean_difference: float
    area: Areas


@dataclass(eq=False)
class Report:
    """What :func:`build` came to; the names are those of ``ptin build --json``.

    Attributes:
        samples: With a height; of points and TINs, distinct positions.
        void_samples: Of rasters: without a height.
        left_out_points: Points that were left out, for want of a number or as the options say.
        merged_points: Points less the positions that they fell on.
        largest_shift: How far snapping moved a point in plan, CRS units, and merging in height.
        height_rounding: How far storing moved a height, at most.
        vertices: Of the full TIN; ``t0_vertices`` of the coarsest.
        bytes, source_bytes: Sizes of the file and of its sources.
        warnings: What was probably meant otherwise than it was taken.
    """

    output: str
    samples: int
    void_samples: int
    lone_samples: int
    left_out_points: int
    empty_inputs: list[str]
    left_out_triangles: int
    void_triangles: int
    merged_points: int
    largest_shift: tuple[float, float]
    height_rounding: float
    vertices: int
    records: int
    t0_vertices: int
    rank: int
    bytes: int
    source_bytes: int
    seconds: float
    resumed: bool
    warnings: list[str]
