#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of bench/peers/viewshed: times, where the answers differ, and who is right about a sample of that.

The judge is a brute force of its own over all edges of the TIN (grid.ply): it shares no code with ptin's sweep.
usage: viewshed_compare.py X Y EYE_HEIGHT RADIUS, in the folder of grid.tif, ptin.tif, grass.tif, gdal.tif, grid.ply
"""
import os
import statistics
import sys

import numpy
from osgeo import gdal

gdal.UseExceptions()
SAMPLE = int(os.environ.get("SAMPLE", "100"))
BEND = 0.85714 / (2 * 6378137.0)


def raster(name):
    file = gdal.Open(name)
    return file.ReadAsArray(), file.GetGeoTransform()


def on_grid(name, shape, transform):
    """A raster of part of the grid, laid on it; NaN elsewhere."""
    values, own = raster(name)
    out = numpy.full(shape, numpy.nan)
    column = round((own[0] - transform[0]) / transform[1])
    row = round((own[3] - transform[3]) / transform[5])
    r0, c0 = max(row, 0), max(column, 0)
    r1, c1 = min(row + values.shape[0], shape[0]), min(column + values.shape[1], shape[1])
    out[r0:r1, c0:c1] = values[r0 - row:r1 - row, c0 - column:c1 - column]
    return out


def read_ply(name):
    with open(name, "rb") as file:
        count = {}
        while (line := file.readline().decode().strip()) != "end_header":
            if line.startswith("element"):
                count[line.split()[1]] = int(line.split()[2])
        points = numpy.fromfile(file, "<f8", 3 * count["vertex"]).reshape(-1, 3)
        faces = numpy.fromfile(file, numpy.dtype([("n", "u1"), ("v", "<i4", 3)]), count["face"])["v"]
    edges = numpy.sort(numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    code = numpy.unique(edges[:, 0].astype(numpy.int64) << 32 | edges[:, 1])
    return points, numpy.stack([code >> 32, code & 0xFFFFFFFF], axis=1)


class Judge:
    """The least clearance of the line to a target over all edges of the TIN, ends left out."""

    def __init__(self, x, y, eye):
        self.points, edges = read_ply("grid.ply")
        self.points[:, :2] -= (x, y)
        self.points[:, 2] -= BEND * (self.points[:, :2] ** 2).sum(axis=1)
        self.a, self.b = self.points[edges[:, 0]], self.points[edges[:, 1]]
        self.eye = eye

    def clearance(self, tx, ty, tz):
        tz -= BEND * (tx * tx + ty * ty)
        da = tx * self.a[:, 1] - ty * self.a[:, 0]
        db = tx * self.b[:, 1] - ty * self.b[:, 0]
        hit = numpy.flatnonzero((da <= 0) != (db <= 0))
        s = da[hit] / (da[hit] - db[hit])
        at = self.a[hit] + s[:, None] * (self.b[hit] - self.a[hit])
        share = (at[:, 0] * tx + at[:, 1] * ty) / (tx * tx + ty * ty)
        inner = (share > 1e-12) & (share < 1 - 1e-9)
        return (self.eye + share[inner] * (tz - self.eye) - at[inner, 2]).min(initial=numpy.inf)


def main():
    x, y, height, radius = map(float, sys.argv[1:])
    ground, transform = raster("grid.tif")
    column, row = int((x - transform[0]) / transform[1]), int((y - transform[3]) / transform[5])
    eye = float(ground[row, column]) + height
    seen = {"ptin": on_grid("ptin.tif", ground.shape, transform) == 255,
            "r.viewshed": on_grid("grass.tif", ground.shape, transform) >= 0,
            "gdal_viewshed": on_grid("gdal.tif", ground.shape, transform) == 255}
    dx = (numpy.arange(ground.shape[1]) - column) * transform[1]
    dy = (numpy.arange(ground.shape[0]) - row) * transform[5]
    within = dx[None, :] ** 2 + dy[:, None] ** 2 <= radius * radius
    within[row, column] = False
    times = {"ptin": "ptin_times", "r.viewshed": "grass_times", "gdal_viewshed": "gdal_times"}
    judge = Judge(x, y, eye)
    chosen = numpy.random.default_rng(1997)

    def right(mask):
        """Of a sample of the pixels: how many of them the judge sees."""
        rows, columns = numpy.nonzero(mask & within)
        pick = chosen.permutation(len(rows))[:SAMPLE]
        clear = [judge.clearance(dx[c], dy[r], float(ground[r, c])) for r, c in zip(rows[pick], columns[pick])]
        return len(pick), sum(c >= -1e-9 for c in clear), len(rows)

    print("| program | seconds, wall | processor | pixels seen of %d | seen where ptin does not: judge agrees | "
          "not seen where ptin does: judge agrees |" % within.sum())
    print("|---|---|---|---|---|---|")
    for name, mask in seen.items():
        wall, user = zip(*(map(float, line.split()) for line in open(times[name]) if line.strip()))
        more, less = "", ""
        if name != "ptin":
            n, yes, count = right(mask & ~seen["ptin"])
            more = "%d: %d of %d" % (count, yes, n)
            n, yes, count = right(~mask & seen["ptin"])
            less = "%d: %d of %d" % (count, n - yes, n)
        print("| %s | %.2f | %.2f | %d | %s | %s |" % (name, statistics.median(wall), statistics.median(user),
                                                      (mask & within).sum(), more, less))
    n, yes, _ = right(seen["ptin"])
    m, no, _ = right(~seen["ptin"])
    print("\nptin alone, random pixels: the judge sees %d of %d that ptin sees, and %d of %d that it does not." % (yes, n, no, m))


if __name__ == "__main__":
    main()
