# SPDX-License-Identifier: GPL-3.0-or-later
"""Building a terrain from files or arrays."""

from __future__ import annotations

import os
import warnings
from contextlib import contextmanager
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _ptin
from .errors import Error, InvalidArgument
from .results import Report
from .terrain import Memory, Path, _bytes, _crs, _whole

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
            32 bits or floats (others become one of these that holds each height), row 0 where the transform says; else
            points, (N, 3) float64: x, y and height. NaN, and what is masked, is void; a point with one is left out.
        output: Path of the ``.ptin`` file.
        transform: Of a grid: the six numbers of :class:`Transform`; rasterio's ``dataset.transform`` too.
        progress: True: a bar of tqdm for each stage. Or a function of (stage, done, total), which is called at most ten
            times a second and at the ends of stages, by threads of the build; what it raises ends the build, and is
            raised here.
        memory: Most bytes of memory of the process, or a text as ``"2G"``; None: 1 GiB, or three quarters of what the
            system allows where that is less.
        threads: 0: as many as are allowed.
        overwrite: An output that is there is replaced.
        resume: Go on with an interrupted build of the same files.
        discard: Remove what an interrupted build has left, and begin anew; done for arrays anyway.
        tmp: Folder of temporary files; "": beside the output.
        **options: Those of ``ptin build`` that decide the bytes of the file, listed below.

    What was probably meant otherwise than it was taken comes as Python's warnings, and in ``Report.warnings``.

    Raises:
        InvalidArgument, NotFound; IoError, ResourceExhausted or KeyboardInterrupt, after which ``resume`` goes on with
        a build of files. One of an array leaves nothing behind.

    >>> heights = np.add.outer(np.arange(50.0), np.arange(60.0))
    >>> report = build(heights, "plane.ptin", transform=(10, 0, 0, 0, -10, 500), a_srs="EPSG:32611", overwrite=True)
    >>> report.samples, report.warnings
    (3000, [])
    """
    if resume and discard:
        raise InvalidArgument("a build is resumed or discarded; leave one out")
    unfinished = _ptin.Unfinished.RESUME if resume else _ptin.Unfinished.DISCARD if discard else _ptin.Unfinished.REFUSE
    output, is_array = os.fspath(output), isinstance(inputs, np.ndarray)
    if is_array and resume:
        raise InvalidArgument("a build of an array cannot be resumed; leave resume out")
    if not is_array and transform is not None:
        raise InvalidArgument("a transform is for arrays; files have their own")
    source = _source(inputs, transform, options) if is_array else None
    names = _names(inputs) if source is None else [source.name]
    unfinished = _ptin.Unfinished.DISCARD if is_array else unfinished
    resources = _ptin.Resources(_bytes(memory) or 0, _whole("threads", threads), overwrite, os.fspath(tmp), unfinished)
    with _told(progress) as tell, _named_array(source, output):
        report = _ptin.build(names, output, _plain(options), resources, tell)
    if source is not None:
        report["warnings"] = [text.replace(source.name, "the array") for text in report["warnings"]]
    for text in report["warnings"]:
        warnings.warn(text, stacklevel=2)
    return Report(output=output, **report)


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
    if hasattr(inputs, "__array__") or not hasattr(inputs, "__iter__"):
        raise InvalidArgument(
            f"a {type(inputs).__name__} is no source: give files, or one numpy array. Of xarray, Dask and pandas that is"
            " numpy.asarray(x), of rasterio dataset.read(1, masked=True), both with transform= and a_srs="
        )
    inputs = list(inputs)  # which an iterator gives once
    if any(isinstance(one, np.ndarray) for one in inputs):
        raise InvalidArgument("a build has one array, or files; join arrays first")
    if not all(isinstance(one, (str, os.PathLike)) for one in inputs):
        raise InvalidArgument("sources are paths, or one numpy array: of lists of numbers it is numpy.array(lists)")
    return [os.fspath(one) for one in inputs]


def _state_of_work(output: str) -> Any:
    """What tells an unfinished build of an output from another one; None: there is none."""
    try:
        status = os.stat(os.path.join(_ptin.work_folder(output), "manifest"))
    except OSError:
        return None
    return (status.st_ino, status.st_mtime_ns, status.st_size)


@contextmanager
def _named_array(source: Any, output: str) -> Iterator[None]:
    """A build of an array: errors say so in place of a file's name, and nothing stays that could not be resumed."""
    before = _state_of_work(output)
    try:
        yield
    except BaseException as raised:
        # What was there before is a build of files, which may go on: this one was refused before it began.
        if source is not None and _state_of_work(output) != before:
            _ptin.discard(output)
        if source is not None and isinstance(raised, Error):
            raised.args = tuple(text.replace(source.name, "the array") for text in raised.args)
            raised.message = raised.message.replace(source.name, "the array")
            raised.context = raised.context.replace(source.name, "the array")
        raise


def _source(array: npt.NDArray[Any], transform: Optional[Sequence[float]], options: dict[str, Any]) -> Any:
    """An array as a source that the engine can read."""
    if transform is None:
        if array.ndim != 2 or array.shape[1] != 3:
            raise InvalidArgument("points are an array of shape (N, 3); a grid needs a transform")
        if isinstance(array, np.ma.MaskedArray):
            array = array.astype(np.float64).filled(np.nan)
        return _ptin.source_of_points(np.ascontiguousarray(array, dtype=np.float64))
    if array.ndim != 2:
        raise InvalidArgument("a grid is an array of rows and columns")
    array = _filled(_of_known_type(array), options)
    try:
        a, b, c, d, e, f = (float(number) for number in tuple(transform)[:6])
    except (TypeError, ValueError):
        raise InvalidArgument("a transform is six numbers: those of rasterio's dataset.transform") from None
    grid = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))
    return _ptin.source_of_grid(grid, _GDAL_TYPES[array.dtype.name], (c, a, b, f, d, e))


def _of_known_type(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The same heights as numbers that GDAL has."""
    if array.dtype.name in _GDAL_TYPES:
        return array
    wider = {"int8": ["int16"], "float16": ["float32"], "int64": ["int32", "float64"], "uint64": ["int32", "float64"]}
    for name in wider.get(array.dtype.name, []):
        with np.errstate(all="ignore"):
            held = array.astype(name)
            if np.ma.allequal(array, held.astype(array.dtype)) or array.dtype.kind == "f":
                return held
    known = ", ".join(_GDAL_TYPES)
    raise InvalidArgument(f"a grid has numbers of {known}, and these are {array.dtype.name}; use array.astype()")


def _filled(array: npt.NDArray[Any], options: dict[str, Any]) -> npt.NDArray[Any]:
    """A grid whose masked heights are void: NaN, or of integers ``options["nodata"]``, which is chosen where it is not
    given."""
    if not isinstance(array, np.ma.MaskedArray):
        return array
    if array.dtype.kind == "f":
        return array.filled(np.nan)
    if options.get("nodata") is None:
        limits = np.iinfo(array.dtype)
        heights = array.compressed()
        fill = int(np.clip(int(array.fill_value), limits.min, limits.max))
        choice = [n for n in (fill, limits.min, limits.max) if not np.any(heights == n)]
        if not choice:
            raise InvalidArgument("a masked array of integers needs nodata, a value that none of its heights has")
        options["nodata"] = choice[0]
    nodata = options["nodata"]
    with np.errstate(all="ignore"):
        held = np.asarray(nodata, dtype=float).astype(array.dtype)
    if held != nodata:
        raise InvalidArgument(f"nodata is {nodata}, which {array.dtype.name} cannot hold; use array.astype()")
    return array.filled(held)


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
