# SPDX-License-Identifier: GPL-3.0-or-later
"""Building a terrain from files or arrays."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _ptin
from .errors import InvalidArgument
from .results import Report
from .terrain import Memory, Path, _bytes, _crs

Progress = Callable[[str, int, int], object]

_GDAL_TYPES = {
    "uint8": "Byte",
    "int16": "Int16",
    "uint16": "UInt16",
    "int32": "Int32",
    "uint32": "UInt32",
    "float32": "Float32",
    "float64": "Float64",
}


def build(
    inputs: Union[Path, npt.NDArray[Any], Iterable[Path]],
    output: Path,
    *,
    transform: Optional[Sequence[float]] = None,
    progress: Union[bool, Progress, None] = None,
    memory: Memory = None,
    threads: int = 0,
    overwrite: bool = False,
    resume: bool = False,
    discard: bool = False,
    tmp: Path = "",
    **options: Any,
) -> Report:
    """Builds a terrain of any size, in the memory that you give. The output appears when it is complete.

    Args:
        inputs: A raster, several of one grid, files of points, or a TIN: what ``ptin build`` takes. Or an array, of
            which nothing is copied where it is contiguous: with ``transform`` a grid, (rows, columns) of integers up to
            32 bits or floats, row 0 where the transform says; else points, (N, 3) float64: x, y and height. NaN, and
            what is masked, is void; a point with one of them is left out.
        output: Path of the ``.ptin`` file.
        transform: Of a grid: the six numbers of :class:`Transform`; rasterio's ``dataset.transform`` too.
        progress: True: a bar of tqdm for each stage. Or a function of (stage, done, total), which is called at most ten
            times a second and at the ends of stages; what it raises ends the build, and is raised here.
        memory: Most bytes of memory of the process, or a text as ``"2G"``; None: 1 GiB, or three quarters of what the
            system allows where that is less.
        threads: 0: as many as are allowed.
        overwrite: An output that is there is replaced.
        resume: Go on with an interrupted build of the same files.
        discard: Remove what an interrupted build has left, and begin anew; done for arrays anyway.
        tmp: Folder of temporary files; "": beside the output.
        **options: Those of ``ptin build`` that decide the bytes of the file, listed below.

    Raises:
        InvalidArgument, NotFound; IoError, ResourceExhausted or KeyboardInterrupt, after which ``resume`` goes on.

    >>> heights = np.add.outer(np.arange(50.0), np.arange(60.0))
    >>> report = build(heights, "plane.ptin", transform=(10, 0, 0, 0, -10, 500), a_srs="EPSG:32611", overwrite=True)
    >>> report.samples, report.warnings
    (3000, [])
    """
    if resume and discard:
        raise InvalidArgument("a build is resumed or discarded; leave one out")
    unfinished = _ptin.Unfinished.RESUME if resume else _ptin.Unfinished.DISCARD if discard else _ptin.Unfinished.REFUSE
    if isinstance(inputs, np.ndarray):
        if resume:
            raise InvalidArgument("a build of an array cannot be resumed; leave resume out")
        source = _source(inputs, transform, options)
        names, unfinished = [source.name], _ptin.Unfinished.DISCARD
    else:
        if transform is not None:
            raise InvalidArgument("a transform is for arrays; files have their own")
        source, names = None, _names(inputs)
    resources = _ptin.Resources(_bytes(memory) or 0, threads, overwrite, os.fspath(tmp), unfinished)
    with _told(progress) as tell:
        report = _ptin.build(names, os.fspath(output), _plain(options), resources, tell)
    del source  # which the build has read until here
    return Report(output=os.fspath(output), **report)


build.__doc__ = (build.__doc__ or "").replace(
    "    Raises:",
    "    Options:\n"
    + "".join(f"        {name} ({kind}): {help}.\n" for name, kind, help in _ptin.build_options())
    + "\n    Raises:",
    1,
)


def _names(inputs: Any) -> list[str]:
    if isinstance(inputs, (str, os.PathLike)):
        return [os.fspath(inputs)]
    inputs = list(inputs)  # which an iterator gives once
    if any(isinstance(one, np.ndarray) for one in inputs):
        raise InvalidArgument("a build has one array, or files; join arrays first")
    return [os.fspath(one) for one in inputs]


def _source(array: npt.NDArray[Any], transform: Optional[Sequence[float]], options: dict[str, Any]) -> Any:
    """An array as a source that the engine can read."""
    if transform is None:
        if array.ndim != 2 or array.shape[1] != 3:
            raise InvalidArgument("points are an array of shape (N, 3); a grid needs a transform")
        if isinstance(array, np.ma.MaskedArray):
            array = array.astype(np.float64).filled(np.nan)
        return _ptin.source_of_points(np.ascontiguousarray(array, dtype=np.float64))
    if isinstance(array, np.ma.MaskedArray):
        nodata = options.get("nodata")
        if nodata is None and array.dtype.kind != "f":
            raise InvalidArgument("a masked array of integers needs nodata, a value that none of its heights has")
        array = array.filled(np.nan if nodata is None else nodata)
    if array.ndim != 2:
        raise InvalidArgument("a grid is an array of rows and columns")
    if array.dtype.name not in _GDAL_TYPES:
        known = ", ".join(_GDAL_TYPES)
        raise InvalidArgument(f"a grid has numbers of {known}, and these are {array.dtype.name}; use array.astype()")
    a, b, c, d, e, f = (float(number) for number in tuple(transform)[:6])
    grid = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))
    return _ptin.source_of_grid(grid, _GDAL_TYPES[array.dtype.name], (c, a, b, f, d, e))


def _plain(options: dict[str, Any]) -> dict[str, Any]:
    """Options as the engine takes them: paths and CRSs as texts, and one file where it wants a list."""
    plain = dict(options)
    for key in ("a_srs", "vertical_crs"):
        if key in plain:
            plain[key] = _crs(plain[key])
    if "boundary" in plain:
        plain["boundary"] = os.fspath(plain["boundary"])
    if "breaklines" in plain:
        plain["breaklines"] = _names(plain["breaklines"])
    return plain


@contextmanager
def _told(progress: Union[bool, Progress, None]) -> Iterator[Optional[Progress]]:
    """The function that is called with progress; bars that are shown are closed in the end."""
    if progress is not True:
        yield progress or None
        return
    from tqdm.auto import tqdm

    bars: dict[str, Any] = {}

    def show(stage: str, done: int, total: int) -> None:
        if stage not in bars:
            for bar in bars.values():
                bar.close()
            bars[stage] = tqdm(total=total, desc=stage, unit_scale=True)
        bars[stage].total = total
        bars[stage].update(done - bars[stage].n)

    try:
        yield show
    finally:
        for bar in bars.values():
            bar.close()
