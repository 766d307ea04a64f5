# SPDX-License-Identifier: GPL-3.0-or-later
"""Terrains on disk or elsewhere, and the questions that they answer."""

from __future__ import annotations

import numbers
import os
import re
import warnings
from typing import Any, Iterable, Iterator, Optional, Sequence, Union, overload

import numpy as np
import numpy.typing as npt

from . import _ptin
from .errors import InvalidArgument
from .results import (
    Areas,
    Bounded,
    Clearance,
    Heights,
    Highest,
    Isolines,
    LinePlace,
    Mesh,
    Place,
    Profile,
    Raster,
    Sight,
    Transform,
    Viewshed,
    Volume,
)

Path = Union[str, "os.PathLike[str]"]
Memory = Union[float, str, None]
Window = Optional[Sequence[float]]

_forks = 0  # of this process since its first one, so that a terrain knows whether it was opened in it


def _count_fork() -> None:
    global _forks
    _forks += 1


os.register_at_fork(after_in_child=_count_fork)

_UNITS_OF_MEMORY = {"": 1, "K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}


def _bytes(memory: Memory) -> Optional[int]:
    """Bytes of memory: a number, or a text as "512M" or "2G".

    >>> _bytes("512M")
    536870912
    """
    if memory is None:
        return None
    if not isinstance(memory, str):
        if not isinstance(memory, numbers.Real) or not 0 <= memory < 2**63:
            raise InvalidArgument(f'{memory} is no size of memory; expected bytes, or a text as "512M" or "2G"')
        return int(memory)
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?", memory.strip(), re.IGNORECASE)
    if not found:
        raise InvalidArgument(f'"{memory}" is no size of memory; expected bytes, or a text as "512M" or "2G"')
    return int(float(found[1]) * _UNITS_OF_MEMORY[found[2].upper()])


def _crs(crs: Any) -> Optional[str]:
    """A CRS as text: of a text itself, of what pyproj, rasterio, geopandas and GDAL have its WKT, of a number EPSG's."""
    if crs is None or isinstance(crs, str):
        return crs
    if isinstance(crs, numbers.Integral) and not isinstance(crs, bool):
        return f"EPSG:{int(crs)}"
    to_wkt = getattr(crs, "to_wkt", None) or getattr(crs, "ExportToWkt", None)
    if to_wkt is None:
        raise InvalidArgument(f"a CRS is text, an EPSG number, or what has to_wkt() as pyproj.CRS has; this is {crs!r}")
    return str(to_wkt())


def _whole(name: str, number: Any) -> Any:
    """A whole number that is asked for, from 0 on; None passes."""
    if number is None:
        return None
    is_number = isinstance(number, numbers.Real) and not isinstance(number, bool)
    if not is_number or not 0 <= number < 2**63 or int(number) != number:
        raise InvalidArgument(f"{name} is a whole number, 0 or above, and not {number!r}")
    return int(number)


def _corners(points: Any) -> npt.NDArray[np.float64]:
    """The corners of a line or a ring: (N, 2); a third column, heights, is left out."""
    if isinstance(points, np.ma.MaskedArray) and np.ma.is_masked(points):
        raise InvalidArgument("corners of a line or a polygon are masked; leave them out")
    try:
        corners = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        corners = np.empty(0)
    if corners.ndim != 2 or corners.shape[1] not in (2, 3):
        raise InvalidArgument("corners of a line or a polygon are an array of shape (N, 2)")
    return corners[:, :2]


def _line(line: Any) -> npt.NDArray[np.float64]:
    shape = getattr(line, "__geo_interface__", line)
    if isinstance(shape, dict) and shape.get("type") != "LineString":
        raise InvalidArgument(f"a line is a LineString or an array of shape (N, 2), and this is a {shape.get('type')}")
    return _corners(shape["coordinates"] if isinstance(shape, dict) else shape)


def _geometries(shape: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The polygons of GeoJSON, as it is in a file or in ``__geo_interface__``."""
    kind = shape.get("type")
    if kind in ("Polygon", "MultiPolygon"):
        yield shape
    elif kind == "Feature" and shape.get("geometry"):
        yield from _geometries(shape["geometry"])
    elif kind in ("FeatureCollection", "GeometryCollection"):
        for part in shape["features" if kind == "FeatureCollection" else "geometries"]:
            yield from _geometries(part)
    else:
        raise InvalidArgument(f"a polygon is wanted, and this is a {kind}")


def _rings(polygon: Any) -> list[npt.NDArray[np.float64]]:
    """The rings of a polygon, in any order: borders and holes are told apart by lying in each other."""
    shape = getattr(polygon, "__geo_interface__", polygon)
    if not isinstance(shape, dict):
        is_ring = len(shape) > 0 and np.ndim(shape[0]) == 1
        return [_corners(ring) for ring in ([shape] if is_ring else shape)]
    if shape.get("type") == "MultiPolygon" and getattr(polygon, "is_valid", True) is False:
        raise InvalidArgument("this MultiPolygon is not valid, as where its parts overlap; use shapely.make_valid()")
    parts = list(_geometries(shape))
    if len(parts) > 1:  # which may overlap, and then do not exclude each other
        from shapely.geometry import shape as shaped
        from shapely.ops import unary_union

        return _rings(unary_union([shaped(part) for part in parts]))
    (part,) = parts or [{"type": "MultiPolygon", "coordinates": []}]
    polygons = [part["coordinates"]] if part["type"] == "Polygon" else part["coordinates"]
    return [_corners(ring) for rings in polygons for ring in rings if len(ring) > 0]


def _window(window: Sequence[float]) -> tuple[float, ...]:
    """The four numbers of a window."""
    if np.shape(window) != (4,):
        raise InvalidArgument("a window is four numbers: xmin, ymin, xmax, ymax")
    return tuple(map(float, window))


def _end(end: Sequence[float]) -> tuple[float, float, float]:
    """An end of a line of sight; two numbers are one 2 above ground."""
    x, y, *height = map(float, end)
    return (x, y, height[0] if height else 2.0)


def _pair(size: Any) -> Any:
    """The sides of a pixel; of one number both."""
    if size is None:
        return None
    pair = np.asarray(size)
    if pair.shape not in ((), (2,)) or pair.dtype.kind not in "iuf":
        raise InvalidArgument(f"a pixel_size is a number, or width and height, and not {size!r}")
    return tuple(float(side) for side in np.broadcast_to(pair, 2))


def _counts(size: Any) -> Any:
    if size is None:
        return None
    if np.shape(size) != (2,):
        raise InvalidArgument(f"a size is columns and rows, two numbers, and not {size!r}")
    return tuple(_whole("each of size", count) for count in size)


def _place(place: Any) -> Optional[LinePlace]:
    return None if place is None else LinePlace(*place)


def open(path: Path, memory: Memory = None, timeout: Optional[float] = None) -> Terrain:
    """Opens a terrain: a ``.ptin`` file, or one elsewhere.

    Args:
        path: A path, or a URL (``https://``, ``s3://``, ``gs://``, ``az://``) or a name of GDAL's (``/vsi...``).
        memory: Most bytes that a question may take, with the array of a raster, or a text as ``"2G"``; None: 4 GiB,
            and 1 GiB a part of :meth:`Terrain.parts`. A question that needs more raises ResourceExhausted.
        timeout: Of what lies elsewhere: seconds, about, in which a silent server becomes an IoError. It is asked five
            times meanwhile; None: each time 30.

    Raises:
        NotFound, Corruption, UnsupportedVersion, IoError.

    >>> with open("dem.ptin") as t:
    ...     t.crs, t.samples, t.vertices
    ('EPSG:32611', 66049, 66049)
    """
    return Terrain(path, memory, timeout)


class Terrain:
    """A terrain that answers questions. Made by :func:`open`; a context manager; pickled by its path, and opened anew
    in the child of a fork.

    Of each question ``error`` is the certified error allowed, in the height's unit, 0 too; None: the full TIN. Instead
    of an error ``vertices=N`` asks for the TIN of the terrain's N most important vertices. ``window`` is ``(xmin, ymin,
    xmax, ymax)`` in map units; ``polygon`` a shapely or geopandas geometry, anything with ``__geo_interface__``, an
    (N, 2) array or a list of those, the rings, or as text a vector file or WKT, as ``ptin --polygon`` takes it. ``crs``
    is that of the window, polygon or line where it is not the terrain's (files and geopandas have their own): sides are
    straight there, and kept within a hundredth of the distance between samples. Where a region misses the terrain, a
    warning says so.

    Questions release the GIL and may be asked by several threads at once. Ctrl-C ends that of the main thread, as a
    rule within a tenth of a second; the end of Python ends those of daemon threads, by SystemExit. Each raises
    InvalidArgument, ResourceExhausted, Corruption or IoError.
    """

    def __init__(self, path: Path, memory: Memory = None, timeout: Optional[float] = None) -> None:
        name = os.fsdecode(path)
        if timeout is not None and not (isinstance(timeout, numbers.Real) and timeout > 0):
            raise InvalidArgument(f"a timeout is seconds, above 0, and not {timeout!r}")
        self._timeout = timeout
        self._opened: Any = _ptin.open(name, timeout)
        self._forks = _forks
        self._name = name if "://" in name or name.startswith("/vsi") else os.path.abspath(name)
        self._memory = _bytes(memory)
        self._plain = _ptin.Asked(None, None, self._memory)

    @property
    def _terrain(self) -> Any:
        if self._opened is None:
            raise ValueError("this terrain is closed")
        if self._forks != _forks:  # connections and locks are the parent's
            _ptin.never_close(self._opened)
            self._opened, self._forks = _ptin.open(self._name, self._timeout), _forks
        if self._opened.is_stopped:  # by Ctrl-C, while it waited for a server
            self._opened = _ptin.open(self._name, self._timeout)
        return self._opened

    def _asked(self, error: Optional[float], vertices: Optional[int], memory: Memory = None) -> Any:
        if error is None and vertices is None and memory is None:
            return self._plain
        if error is not None and (isinstance(error, (str, bytes)) or np.ndim(error) != 0):
            raise TypeError(f"an error is a number, in the unit of heights, and not {error!r}")
        limit = self._memory if memory is None else _bytes(memory)
        return _ptin.Asked(error, _whole("vertices", vertices), limit)

    def _region(self, window: Window, polygon: Any, crs: Any = None) -> Any:
        """The region of a question, in the terrain's CRS."""
        if polygon is not None and window is not None:
            raise InvalidArgument("a region is a window or a polygon; leave one out")
        is_text = isinstance(polygon, (str, os.PathLike))
        if crs is not None and (is_text or (window is None and polygon is None)):
            raise InvalidArgument("a crs is that of a window or polygon that is given by numbers; leave it out")
        if window is None and polygon is None:
            return None
        region: Any = None
        if is_text:
            region = _ptin.rings_of_file(self._terrain, os.fspath(polygon))
        elif polygon is not None:
            region = _rings(polygon)
            crs = getattr(polygon, "crs", None) if crs is None and self.crs else crs
        else:
            region = _window(() if window is None else window)
            if crs is not None:
                xmin, ymin, xmax, ymax = region
                region = [np.array([(xmin, ymin), (xmax, ymin), (xmax, ymax), (xmin, ymax)])]
        if crs is not None:
            closed = [np.concatenate([ring, ring[:1]]) for ring in region]
            region = [ring[:-1] for ring in _ptin.paths_of_crs(self._terrain, closed, _crs(crs))]
        self._warn_of_miss(region if isinstance(region, list) else [np.reshape(region, (2, 2))])
        return region

    def _warn_of_miss(self, rings: Sequence[npt.NDArray[np.float64]]) -> None:
        """Warns where the box of a region misses that of the terrain: numbers of another CRS, as a rule."""
        corners = np.concatenate([*rings, np.empty((0, 2))])
        if len(corners) == 0:
            return
        (xmin, ymin), (xmax, ymax), bounds = corners.min(axis=0), corners.max(axis=0), self.bounds
        if xmax < bounds[0] or ymax < bounds[1] or xmin > bounds[2] or ymin > bounds[3]:
            why = _ptin.why_missed(self._terrain, corners)
            warnings.warn(f"the region misses the terrain, which has {why}", stacklevel=4)

    def close(self) -> None:
        """Closes the file; questions that are being answered end as if it were open."""
        if self._opened is not None and self._forks != _forks:
            _ptin.never_close(self._opened)
        self._opened = None

    def __enter__(self) -> Terrain:
        return self

    def __exit__(self, *raised: Any) -> None:
        self.close()

    def __reduce__(self) -> Any:
        return (Terrain, (self._name, self._memory, self._timeout))

    def __repr__(self) -> str:
        return f"ptin.open({self._name!r})" + (" (closed)" if self._opened is None else "")

    # What is known without a question.

    @property
    def path(self) -> str:
        """The path, or the URL."""
        return self._name

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """xmin, ymin, xmax, ymax of the samples, map units. Pixels of a raster reach half a pixel beyond."""
        return self._terrain.bounds

    @property
    def crs(self) -> str:
        """The CRS: a code as ``EPSG:32611``, or WKT where it has none; empty where it is unknown."""
        return self._terrain.crs

    @property
    def vertical_crs(self) -> str:
        """The vertical CRS, or its name; empty where it is unknown or a part of ``crs``."""
        return self._terrain.vertical_crs

    @property
    def wkt(self) -> str:
        """Horizontal and vertical CRS as WKT."""
        return self._terrain.wkt

    @property
    def units(self) -> dict[str, str]:
        """The names of the units; ``unknown`` where nobody knows.

        >>> t.units
        {'horizontal': 'metre', 'height': 'metre', 'length': 'metre', 'ground': 'metre'}

        ``horizontal`` is the map unit, ``height`` that of heights and errors, ``length`` that of distances of a profile,
        ``ground`` the one whose squares and cubes areas and volumes are.
        """
        return self._terrain.units

    @property
    def samples(self) -> int:
        """Samples with a height in the source."""
        return self._terrain.samples

    @property
    def vertices(self) -> int:
        """Vertices of the full TIN, those of voids included."""
        return self._terrain.vertices

    @property
    def pixel_size(self) -> Optional[tuple[float, float]]:
        """Width and height of a pixel of the raster that it was built from, map units; None: it was none."""
        return self._terrain.pixel_size

    @property
    def height_range(self) -> Optional[tuple[float, float]]:
        """The least and the greatest height of all samples; None where all is void.

        >>> t.height_range
        (633.0, 1576.0)
        """
        return self._terrain.height_range

    @property
    def errors(self) -> npt.NDArray[np.float64]:
        """(K, 2) float64, falling: errors, and how many vertices the TIN within each has. Reads no page.

        >>> coarse = t.errors[t.errors[:, 0] > 20]
        >>> int(coarse[-1, 1]) < t.vertices / 20
        True
        """
        return self._terrain.errors

    @property
    def base_error(self) -> float:
        """How far the file's finest TIN is from its source at a sample: what ``max_error`` left out, and rounding."""
        return self._terrain.base_error

    def border_moved_at_most(self, certified_error: float) -> float:
        """How far the border between surface and void may be from that of the source in an answer that certifies this
        error: metres where the CRS is in degrees, else map units. 0 without voids; infinite where nothing bounds it."""
        return self._terrain.border_moved_at_most(certified_error)

    # Questions.

    def locate(
        self,
        xy: npt.ArrayLike,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        crs: Any = None,
        memory: Memory = None,
    ) -> Heights:
        """Heights at points: exact, or with the interval that is certain.

        Args:
            xy: (N, 2) map units, taken without a copy where it is float64 and contiguous; or one (x, y). What is NaN,
                infinite or masked, or has no place in the terrain's CRS, is OUTSIDE: its height is NaN.
            crs: The CRS of ``xy``, x to the east, where it is not the terrain's: text, an EPSG number, or what has
                ``to_wkt()``.

        >>> t.locate((378000, 3804000)).z
        947.5253908634186
        >>> h = t.locate([[378000, 3804000], [0, 0]], error=5)
        >>> bool(h.low[0] <= 947.5 <= h.high[0]), h.state.tolist()
        (True, [0, 2])
        """
        if isinstance(xy, np.ma.MaskedArray):
            xy = xy.astype(np.float64).filled(np.nan)
        if getattr(getattr(xy, "dtype", None), "kind", "f") == "c":
            raise TypeError("positions are real numbers, and these are complex")
        asked = self._asked(error, vertices, memory)
        return Heights(*_ptin.locate(self._terrain, xy, asked, None if crs is None else _crs(crs)))

    def profile(
        self,
        line: npt.ArrayLike,
        error: Optional[float] = None,
        stations: Optional[float] = None,
        vertices: Optional[int] = None,
        crs: Any = None,
        memory: Memory = None,
    ) -> Profile:
        """Heights along a line, with a break at every edge of the TIN that it crosses.

        Args:
            line: (N, 2) map units, or a shapely LineString.
            stations: Beside the breaks, heights at equal distances: map units, in degrees metres.

        >>> distance, xy, z, state = t.profile([[377000, 3804000], [378000, 3804000]], stations=100)
        >>> float(distance[-1]), xy.shape == (len(z), 2)
        (1000.0, True)
        """
        corners = _line(line)
        if crs is not None:
            (corners,) = _ptin.paths_of_crs(self._terrain, [corners], _crs(crs))
        answer = _ptin.profile(self._terrain, corners, stations, self._asked(error, vertices, memory))
        distance, xy, z, state, station, certificate = answer
        return Profile(*certificate, distance, xy, z, state, station.view(np.bool_))

    def refine(
        self,
        window: Window = None,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        clip: bool = False,
        polygon: Any = None,
        triangles: Optional[int] = None,
        crs: Any = None,
        memory: Memory = None,
    ) -> Mesh:
        """The TIN at a level of detail, as arrays that trimesh, meshio and PyVista take.

        With a region the mesh is fine there and coarse elsewhere; ``vertices`` and ``triangles`` count all of it, voids
        too.

        Args:
            clip: Keep the triangles that meet the region alone.
            triangles: Instead of an error or vertices: at most so many.

        >>> vertices, faces = t.refine(error=20)
        >>> vertices.shape[1], faces.shape[1], faces.dtype
        (3, 3, dtype('int32'))
        """
        asked = self._asked(error, vertices, memory)
        region = self._region(window, polygon, crs)
        most = _whole("triangles", triangles)
        vertex_array, faces, certificate = _ptin.refine(self._terrain, region, clip, most, asked)
        return Mesh(*certificate, vertex_array, faces)

    def parts(
        self,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        window: Window = None,
        polygon: Any = None,
        crs: Any = None,
        memory: Memory = None,
    ) -> Iterator[Mesh]:
        """The TIN at a level of detail in parts that together have each triangle once: for terrains larger than memory.

        Each part has all vertices of its faces, so that those along its border come again in other parts, equal in each
        bit. With a region, the triangles that meet it. The next part is made while one is used.

        Args:
            memory: Most bytes for what is in memory at once; None: that of the terrain, or 1 GiB.

        >>> whole = t.refine(error=20)
        >>> sum(len(faces) for vertices, faces in t.parts(error=20, memory="4M")) == len(whole.faces)
        True
        """
        asked = self._asked(error, vertices, memory)
        parts = _ptin.Parts(self._terrain, self._region(window, polygon, crs), asked)
        return self._each(parts)

    @staticmethod
    def _each(parts: Any) -> Iterator[Mesh]:
        certificate = parts.certificate()
        while (arrays := parts.next()) is not None:
            yield Mesh(*certificate, *arrays)

    def raster(
        self,
        window: Window = None,
        size: Optional[tuple[int, int]] = None,
        pixel_size: Union[float, tuple[float, float], None] = None,
        error: Union[float, str, None] = "pixels",
        vertices: Optional[int] = None,
        memory: Memory = None,
    ) -> Raster:
        """Heights at the centres of pixels; what rasterio writes: ``array, transform, crs``.

        Args:
            window: Without one all that the terrain covers.
            size: Columns and rows of pixels that fill the window.
            pixel_size: Instead: the side of a pixel, or width and height, map units. Centres stand at whole multiples of
                it from the south-western sample, so that rasters of one size fit together. With neither, the pixels of
                the raster that the terrain was built from.
            error: ``"pixels"``: as fine as the pixels, which changes with their number; None: the full TIN.

        >>> array, transform, crs = t.raster(error=None)
        >>> array.shape, float(transform.a) == t.pixel_size[0], crs
        ((257, 257), True, 'EPSG:32611')
        """
        if isinstance(error, str) and error != "pixels":
            raise InvalidArgument(f'an error is a number, None or "pixels", and not "{error}"')
        is_fine = error == "pixels" and vertices is None
        asked = self._asked(None if isinstance(error, str) else error, vertices, memory)
        answer = _ptin.raster(
            self._terrain, self._region(window, None), _counts(size), _pair(pixel_size), is_fine, asked
        )
        array, transform, certificate = answer
        return Raster(*certificate, array, Transform(*transform), self.crs)

    def isolines(
        self,
        interval: Optional[float] = None,
        levels: Optional[Iterable[float]] = None,
        window: Window = None,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        polygon: Any = None,
        base: float = 0.0,
        crs: Any = None,
        memory: Memory = None,
    ) -> Isolines:
        """Isolines, joined over the whole terrain and cut at the region.

        Args:
            interval: Every multiple of it, from ``base``; height's unit.
            levels: Instead: heights of the lines.

        >>> lines = t.isolines(interval=500)
        >>> np.unique(lines.level).tolist(), len(lines.offsets) == len(lines) + 1
        ([1000.0, 1500.0], True)
        """
        if (interval is None) == (levels is None):
            raise InvalidArgument("isolines have an interval or levels; give one of them")
        if levels is not None and not hasattr(levels, "__len__") and hasattr(levels, "__iter__"):
            levels = list(levels)
        heights = [] if levels is None else [float(level) for level in np.ma.ravel(levels).compressed()]
        asked = self._asked(error, vertices, memory)
        answer = _ptin.isolines(self._terrain, heights, interval, base, self._region(window, polygon, crs), asked)
        coords, offsets, level, ring, certificate = answer
        return Isolines(*certificate, coords, offsets, level, ring.view(np.bool_), self.crs)

    def highest(
        self,
        window: Window = None,
        polygon: Any = None,
        lowest: bool = False,
        listed: int = 1,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        crs: Any = None,
        memory: Memory = None,
    ) -> Highest:
        """The highest point of the terrain or of a region.

        Args:
            lowest: The lowest point instead; "highest" then means that.
            listed: How many of the highest vertices to list.

        >>> t.highest().point.height
        1576.0
        """
        asked = self._asked(error, vertices, memory)
        most = min(_whole("listed", listed), 2**32 - 1)
        answer = _ptin.highest(self._terrain, self._region(window, polygon, crs), lowest, most, asked)
        state, point, at_vertex, low, high, vertex_array, certificate = answer
        place = Place(*point) if state == "surface" else None
        return Highest(*certificate, state, place, at_vertex, low, high, vertex_array)

    def sight(
        self,
        a: Sequence[float],
        b: Sequence[float],
        absolute: bool = False,
        verdict: bool = False,
        curvature: float = 0.85714,
        frequency: Optional[float] = None,
        budget: Optional[int] = None,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        memory: Memory = None,
    ) -> Sight:
        """Whether two points see each other, decided exactly.

        Args:
            a, b: (x, y, height above ground), or (x, y): 2 above it.
            absolute: Heights of the ends are absolute.
            verdict: Only the verdict: faster; ``obstruction`` is then any point below ground.
            curvature: The Earth's curvature less refraction: GDAL's coefficient; 0 is a flat Earth, 1 one without
                refraction, 0.75 the 4/3 Earth of radio.
            frequency: Hertz; measures the first Fresnel zone.
            budget: Stop after so many stars; may answer undecided, as with an error.

        >>> t.sight((376904, 3804594, 2), (381569, 3802757, 2)).verdict
        'hidden'
        """
        asked = self._asked(error, vertices, memory)
        stars = _whole("budget", budget)
        answer = _ptin.sight(self._terrain, _end(a), _end(b), absolute, verdict, curvature, frequency, stars, asked)
        told, ends, length, obstruction, at, low, high, void_length, ratio, fresnel, deviation, exact = answer
        clearance = Clearance(low, high, _place(at))
        return Sight(
            told, ends, length, _place(obstruction), clearance, void_length, ratio, _place(fresnel), deviation, exact
        )

    def viewshed(
        self,
        eye: Sequence[float],
        radius: float,
        target: float = 0.0,
        absolute: bool = False,
        curvature: float = 0.85714,
        pixel_size: Union[float, tuple[float, float], None] = None,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        memory: Memory = None,
    ) -> Viewshed:
        """What one observer sees, as a raster of pixels.

        Args:
            eye: (x, y, height above ground), or (x, y): 2 above it.
            radius: How far to look: map units, in degrees metres.
            target: Height of targets above the surface.
            absolute: The observer's height is absolute.
            curvature: As of :meth:`sight`.
            pixel_size: Map units; without it the steps of the grid, which are far too fine where the source was points.
            error: At the radius, less towards the observer.

        >>> seen = t.viewshed((378000, 3804000, 2), radius=1000)
        >>> seen.array.dtype, seen.visible == (seen.array == 255).sum(), seen.undecided
        (dtype('uint8'), True, 0)
        """
        if pixel_size is None and self.pixel_size is None:
            raise InvalidArgument("this terrain was not built from a raster, so it has no pixels; give pixel_size")
        asked = self._asked(error, vertices, memory)
        answer = _ptin.viewshed(
            self._terrain, _end(eye), radius, target, absolute, curvature, _pair(pixel_size), asked
        )
        array, transform, eye_height, visible, hidden, undecided, certificate = answer
        return Viewshed(*certificate, array, Transform(*transform), self.crs, eye_height, visible, hidden, undecided)

    @overload
    def volume(self, level: float = 0.0, *more: Any, **asked: Any) -> Volume: ...

    @overload
    def volume(self, level: Sequence[float], *more: Any, **asked: Any) -> list[Volume]: ...

    def volume(
        self,
        level: Union[float, Sequence[float]] = 0.0,
        against: Union[Terrain, Path, None] = None,
        window: Window = None,
        polygon: Any = None,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        threads: int = 0,
        crs: Any = None,
        memory: Memory = None,
    ) -> Any:
        """Volumes over and under a level, or between two terrains.

        Args:
            level: A height; of several the answer is a list of volumes, one each.
            against: Instead: a second terrain, on any grid, in the same CRS; cut is where this one is above it.
            threads: At most; 0: as many as are allowed.

        >>> v = t.volume(level=1000)
        >>> v.net.volume == v.cut.volume - v.fill.volume, v.exact
        (True, True)
        """
        if isinstance(against, (str, os.PathLike)):
            with Terrain(against, self._memory) as other:
                return self.volume(level, other, window, polygon, error, vertices, threads, crs, memory)
        levels = [float(one) for one in np.ravel(np.asarray(level))]
        other_terrain = None if against is None else against._terrain
        asked = self._asked(error, vertices, memory)
        answer = _ptin.volumes(
            self._terrain, levels, other_terrain, self._region(window, polygon, crs), _whole("threads", threads), asked
        )
        asked_levels = levels if against is None else [None]
        volumes = [self._volume(one, told) for one, told in zip(asked_levels, answer)]
        return volumes[0] if against is not None or np.ndim(level) == 0 else volumes

    @staticmethod
    def _volume(level: Optional[float], told: Any) -> Volume:
        cut, fill, net, rounding, mean_difference, areas, error, deviation, exact = told
        volumes = (Bounded(*cut), Bounded(*fill), Bounded(*net))
        return Volume(error, deviation, exact, level, *volumes, rounding, mean_difference, Areas(*areas))
