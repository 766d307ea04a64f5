# SPDX-License-Identifier: GPL-3.0-or-later
"""Terrains on disk or elsewhere, and the questions that they answer."""

from __future__ import annotations

import numbers
import os
import re
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
    """A CRS as text: of a text itself, of what pyproj, rasterio and geopandas have its WKT, of a number EPSG's."""
    if crs is None or isinstance(crs, str):
        return crs
    return f"EPSG:{int(crs)}" if isinstance(crs, numbers.Integral) else str(crs.to_wkt())


def _rings(polygon: Any) -> list[npt.NDArray[np.float64]]:
    """The rings of a polygon, in any order: borders and holes are told apart by lying in each other."""
    shape = getattr(polygon, "__geo_interface__", polygon)
    if isinstance(shape, dict):
        parts = {"Polygon": [shape["coordinates"]], "MultiPolygon": shape["coordinates"]}.get(shape["type"])
        if parts is None:
            raise InvalidArgument(f"a polygon is wanted, and this is a {shape['type']}")
        return [np.asarray(ring, dtype=float)[:, :2] for part in parts for ring in part]
    if len(shape) > 0 and np.ndim(shape[0]) == 1:
        return [np.asarray(shape, dtype=float)]
    return [np.asarray(ring, dtype=float) for ring in shape]


def _window(window: Sequence[float]) -> tuple[float, ...]:
    """The four numbers of a window."""
    if np.shape(window) != (4,):
        raise InvalidArgument("a window is four numbers: xmin, ymin, xmax, ymax")
    return tuple(map(float, window))


def _region(window: Window, polygon: Any) -> Any:
    if polygon is None:
        return None if window is None else _window(window)
    if window is not None:
        raise InvalidArgument("a region is a window or a polygon; leave one out")
    return _rings(polygon)


def _end(end: Sequence[float]) -> tuple[float, float, float]:
    """An end of a line of sight; two numbers are one 2 above ground."""
    x, y, *height = map(float, end)
    return (x, y, height[0] if height else 2.0)


def _pair(size: Any) -> Any:
    return None if size is None else (size, size) if np.ndim(size) == 0 else tuple(size)


def _place(place: Any) -> Optional[LinePlace]:
    return None if place is None else LinePlace(*place)


def open(path: Path, memory: Memory = None) -> Terrain:
    """Opens a terrain: a ``.ptin`` file, or one elsewhere.

    Args:
        path: A path, or a URL (``https://``, ``s3://``, ``gs://``, ``az://``) or a name of GDAL's (``/vsi...``).
        memory: Most bytes that a question may take, with the array of a raster, or a text as ``"2G"``; None: 4 GiB,
            and 1 GiB a part of :meth:`Terrain.parts`. A question that needs more raises ResourceExhausted.

    Raises:
        NotFound, Corruption, UnsupportedVersion, IoError.

    >>> with open("dem.ptin") as t:
    ...     t.crs, t.samples, t.vertices
    ('EPSG:32611', 66049, 66049)
    """
    return Terrain(path, memory)


class Terrain:
    """A terrain that answers questions. Made by :func:`open`; a context manager; pickled by its path, and opened anew
    in the child of a fork.

    Of each question ``error`` is the certified error allowed, in the height's unit, 0 too; None: the full TIN. Instead
    of an error ``vertices=N`` asks for the TIN of the terrain's N most important vertices. ``window`` is ``(xmin, ymin,
    xmax, ymax)`` in map units; ``polygon`` a shapely geometry, anything with ``__geo_interface__``, an (N, 2) array or
    a list of those, the rings.

    Questions release the GIL and may be asked by several threads at once. Ctrl-C ends that of the main thread, as a
    rule within a tenth of a second; the end of Python ends those of daemon threads, by SystemExit. Each raises
    InvalidArgument, ResourceExhausted, Corruption or IoError.
    """

    def __init__(self, path: Path, memory: Memory = None) -> None:
        name = os.fsdecode(path)
        self._opened: Any = _ptin.open(name)
        self._pid = os.getpid()
        self._name = name if "://" in name or name.startswith("/vsi") else os.path.abspath(name)
        self._memory = _bytes(memory)

    @property
    def _terrain(self) -> Any:
        if self._opened is None:
            raise ValueError("this terrain is closed")
        if self._pid != os.getpid():  # a fork: connections and locks are the parent's
            _ptin.never_close(self._opened)
            self._opened, self._pid = _ptin.open(self._name), os.getpid()
        if self._opened.is_stopped:  # by Ctrl-C, while it waited for a server
            self._opened = _ptin.open(self._name)
        return self._opened

    def _asked(self, error: Optional[float], vertices: Optional[int], memory: Memory = None) -> Any:
        if error is not None and (isinstance(error, (str, bytes)) or np.ndim(error) != 0):
            raise TypeError(f"an error is a number, in the unit of heights, and not {error!r}")
        return _ptin.Asked(error, vertices, self._memory if memory is None else _bytes(memory))

    def close(self) -> None:
        """Closes the file; questions that are being answered end as if it were open."""
        if self._opened is not None and self._pid != os.getpid():
            _ptin.never_close(self._opened)
        self._opened = None

    def __enter__(self) -> Terrain:
        return self

    def __exit__(self, *raised: Any) -> None:
        self.close()

    def __reduce__(self) -> Any:
        return (Terrain, (self._name, self._memory))

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
        memory: Memory = None,
    ) -> Profile:
        """Heights along a line, with a break at every edge of the TIN that it crosses.

        Args:
            line: (N, 2) map units.
            stations: Beside the breaks, heights at equal distances: map units, in degrees metres.

        >>> distance, xy, z, state = t.profile([[377000, 3804000], [378000, 3804000]], stations=100)
        >>> float(distance[-1]), xy.shape == (len(z), 2)
        (1000.0, True)
        """
        answer = _ptin.profile(self._terrain, line, stations, self._asked(error, vertices, memory))
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
        vertex_array, faces, certificate = _ptin.refine(self._terrain, _region(window, polygon), clip, triangles, asked)
        return Mesh(*certificate, vertex_array, faces)

    def parts(
        self,
        error: Optional[float] = None,
        vertices: Optional[int] = None,
        window: Window = None,
        polygon: Any = None,
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
        parts = _ptin.Parts(self._terrain, _region(window, polygon), asked)
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
        answer = _ptin.raster(self._terrain, _region(window, None), size, _pair(pixel_size), is_fine, asked)
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
        heights = [] if levels is None else [float(level) for level in np.ravel(np.asarray(levels))]
        asked = self._asked(error, vertices, memory)
        answer = _ptin.isolines(self._terrain, heights, interval, base, _region(window, polygon), asked)
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
        answer = _ptin.highest(self._terrain, _region(window, polygon), lowest, listed, asked)
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
        answer = _ptin.sight(self._terrain, _end(a), _end(b), absolute, verdict, curvature, frequency, budget, asked)
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
                return self.volume(level, other, window, polygon, error, vertices, threads, memory)
        levels = [float(one) for one in np.ravel(np.asarray(level))]
        other_terrain = None if against is None else against._terrain
        asked = self._asked(error, vertices, memory)
        answer = _ptin.volumes(self._terrain, levels, other_terrain, _region(window, polygon), threads, asked)
        asked_levels = levels if against is None else [None]
        volumes = [self._volume(one, told) for one, told in zip(asked_levels, answer)]
        return volumes[0] if against is not None or np.ndim(level) == 0 else volumes

    @staticmethod
    def _volume(level: Optional[float], told: Any) -> Volume:
        cut, fill, net, rounding, mean_difference, areas, error, deviation, exact = told
        volumes = (Bounded(*cut), Bounded(*fill), Bounded(*net))
        return Volume(error, deviation, exact, level, *volumes, rounding, mean_difference, Areas(*areas))
