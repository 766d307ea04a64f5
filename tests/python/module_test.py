#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tests of the Python module.

usage: module_test.py BUILD ROOT [unittest's arguments]
BUILD is the folder of the build, which holds the program and the package, ROOT the tree. Exit status 77, with a sentence,
where what the module needs is not installed."""

import doctest
import errno
import glob
import importlib
import json
import os
import pickle
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
from unittest import mock

if len(sys.argv) < 3:
    sys.exit(__doc__)
BUILD, ROOT = (os.path.abspath(path) for path in sys.argv[1:3])
PROGRAM = os.path.join(BUILD, "bin/ptin")
sys.path.insert(0, os.path.join(BUILD, "python"))
try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
# A module that was built and cannot be imported is a fault: a symbol that no source defines is found here alone.
import ptin

RASTER = os.path.join(ROOT, "tests/data/mountains_257.tif")
EYES = ((376904, 3804594, 2), (381569, 3802757, 2))
folder = tempfile.TemporaryDirectory()


def setUpModule():
    os.chdir(folder.name)
    ptin.build(RASTER, "dem.ptin", vertical_crs="EPSG:5773")


def told(*arguments):
    """What the program tells as JSON."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def positions(terrain, count, seed=1):
    xmin, ymin, xmax, ymax = terrain.bounds
    return np.random.default_rng(seed).random((count, 2)) * [xmax - xmin, ymax - ymin] + [xmin, ymin]


def source():
    """The raster that the terrain is built from, as an array and its transform."""
    array, transform, _ = ptin.open("dem.ptin").raster(error=None)
    return array, transform


def large_file(array):
    """A file of whole heights, of numbers alone and a header."""
    array.astype("<i2").tofile("large.bil")
    with open("large.hdr", "w") as header:
        header.write(f"NROWS {array.shape[0]}\nNCOLS {array.shape[1]}\nNBANDS 1\nNBITS 16\nPIXELTYPE SIGNEDINT\nBYTEORDER I\n")
        header.write("LAYOUT BIL\nULXMAP 500000\nULYMAP 4000000\nXDIM 30\nYDIM 30\n")
    return "large.bil"


class OnTerrain(unittest.TestCase):
    def setUp(self):
        self.t = ptin.open("dem.ptin")

    def assert_array(self, array, shape, dtype):
        self.assertIsInstance(array, np.ndarray)
        self.assertEqual(array.shape, shape)
        self.assertEqual(array.dtype, np.dtype(dtype))

    def assert_certified(self, answer, error):
        if error is None:
            self.assertEqual((answer.certified_error, answer.certified_deviation, answer.exact), (0, 0, True))
        else:
            self.assertLessEqual(answer.certified_error, error)
            self.assertGreaterEqual(answer.certified_deviation, answer.certified_error)
            self.assertFalse(answer.exact)


class Answers(OnTerrain):
    """Shape, type and certificate of each answer."""

    def test_locate_gives_arrays_of_points_and_numbers_of_one_point(self):
        for error in (None, 5.0):
            h = self.t.locate(positions(self.t, 50), error=error)
            for array in (h.z, h.low, h.high):
                self.assert_array(array, (50,), "f8")
            self.assert_array(h.state, (50,), "u1")
            self.assert_certified(h, error)
            self.assertTrue(np.all((h.low <= h.z) & (h.z <= h.high)))
            np.testing.assert_array_equal(np.asarray(h), h.z)
        one = self.t.locate(positions(self.t, 1)[0])
        self.assertIsInstance(one.z, float)
        self.assertEqual(one.state, ptin.State.SURFACE)

    def test_locate_takes_tuples_lists_arrays_and_integers(self):
        z = self.t.locate((380000.0, 3804000.0)).z
        for xy in ([380000, 3804000], np.array([380000, 3804000]), np.array([380000, 3804000], dtype="f4")):
            self.assertEqual(self.t.locate(xy).z, z)
        wide = np.zeros((3, 4))
        wide[:, 1:3] = (380000, 3804000)
        np.testing.assert_array_equal(self.t.locate(wide[:, 1:3]).z, [z, z, z])
        self.assertEqual(self.t.locate(np.empty((0, 2))).z.shape, (0,))

    def test_millions_are_located_in_portions(self):
        xy = np.full((2**22 + 2, 2), (378000.0, 3804000.0))
        xy[[1, -1]] = (380000, 3804000), (0, 0)
        h = self.t.locate(xy)
        expected = self.t.locate(xy[[0, 1, -1]])
        np.testing.assert_array_equal(h.z[[0, 1, -2, -1]], expected.z[[0, 1, 0, 2]])
        np.testing.assert_array_equal(h.state[[0, 1, -2, -1]], expected.state[[0, 1, 0, 2]])

    def test_locate_finds_outside(self):
        for count in (1, 2000):
            h = self.t.locate(np.zeros((count, 2)))
            self.assertTrue(np.all(np.isnan(h.z)) and np.all(h.state == ptin.State.OUTSIDE))

    def test_locate_of_missing_positions_is_outside(self):
        xy = positions(self.t, 50)
        z = self.t.locate(xy).z
        missing = np.zeros(50, dtype=bool)
        missing[[0, 7, 8, 49]] = True
        gaps = xy.copy()
        gaps[7, 0] = gaps[0] = gaps[49, 1] = np.nan
        gaps[8, 1] = np.inf
        masked = np.ma.MaskedArray(xy, np.column_stack([missing, np.zeros(50, dtype=bool)]))
        for given in (gaps, masked):
            h = self.t.locate(given, error=None)
            np.testing.assert_array_equal(h.z, np.where(missing, np.nan, z))
            np.testing.assert_array_equal(np.isnan(h.low) & np.isnan(h.high), missing)
            self.assertTrue(np.all(h.state[missing] == ptin.State.OUTSIDE))
        for one in ((float("nan"), 3804000), np.full(2, np.nan)):
            h = self.t.locate(one)
            self.assertTrue(np.isnan(h.z) and h.state == ptin.State.OUTSIDE)
        self.assertTrue(np.isnan(self.t.locate(np.full((3, 2), np.nan), vertices=500).z).all())

    def test_locate_of_positions_without_a_place_prints_nothing(self):
        """GDAL prints by C, which only a process of its own shows."""
        asked = (
            f"import sys; sys.path.insert(0, {os.path.dirname(os.path.dirname(ptin.__file__))!r}); import ptin\n"
            "h = ptin.open('dem.ptin').locate([(1e9, 1e9), (-118.304, 34.37), (0, 500)] * 50_000, crs=4326)\n"
            "print(*h.state[:3], *h.state[-3:])\n"
        )
        done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr), ("2 0 2 2 0 2\n", ""))

    def test_locate_takes_positions_of_another_crs(self):
        z = self.t.locate((380000.0, 3804000.0)).z
        there = (-118.304, 34.37)
        by_code, by_number = self.t.locate(there, crs="EPSG:4326"), self.t.locate([there], crs=4326)
        self.assertEqual(by_code.z, by_number.z[0])
        self.assertEqual(self.t.locate(there, crs=np.int64(4326)).z, by_code.z)
        self.assertEqual(by_code.state, ptin.State.SURFACE)
        self.assertEqual(self.t.locate((380000.0, 3804000.0), crs="EPSG:32611").z, z)
        with self.assertRaisesRegex(ptin.InvalidArgument, "no CRS"):
            self.t.locate(there, crs="nonsense")

    def test_profile(self):
        xy = np.array(EYES)[:, :2]
        for error in (None, 20.0):
            p = self.t.profile(xy, error=error)
            distance, places, z, state = p
            self.assert_array(distance, (len(z),), "f8")
            self.assert_array(places, (len(z), 2), "f8")
            self.assert_array(z, distance.shape, "f8")
            self.assert_array(state, distance.shape, "u1")
            self.assert_array(p.station, distance.shape, "?")
            self.assert_certified(p, error)
            np.testing.assert_allclose(z, self.t.locate(places, error=error).z, atol=1e-4)
        self.assertGreater(self.t.profile(xy, stations=500).station.sum(), 2)

    def test_refine(self):
        for error in (None, 20.0):
            mesh = self.t.refine(error=error)
            vertices, faces = mesh
            self.assert_array(vertices, (len(vertices), 3), "f8")
            self.assert_array(faces, (len(faces), 3), "i4")
            self.assert_certified(mesh, error)
            self.assertEqual((faces.min(), faces.max()), (0, len(vertices) - 1))
            a, b, c = (vertices[faces[:, i], :2] for i in range(3))
            twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
            self.assertTrue(np.all(twice > 0))
            xmin, ymin, xmax, ymax = self.t.bounds
            self.assertAlmostEqual(twice.sum() / 2, (xmax - xmin) * (ymax - ymin), delta=1)
        self.assertEqual(len(self.t.refine(vertices=500).vertices), 500)
        self.assertLessEqual(len(self.t.refine(triangles=500).faces), 500)

    def test_regions_are_windows_and_polygons(self):
        xmin, ymin, xmax, ymax = window = (378000, 3803000, 379000, 3804000)
        corners = [(xmin, ymin), (xmax, ymin), (xmax, ymax), (xmin, ymax), (xmin, ymin)]
        asked = len(self.t.refine(window, error=5, clip=True).faces)
        geojson = {"type": "Polygon", "coordinates": [corners]}
        for polygon in (corners, np.array(corners), [corners], geojson):
            self.assertEqual(len(self.t.refine(polygon=polygon, error=5, clip=True).faces), asked)
        hole = [(378300, 3803300), (378700, 3803300), (378700, 3803700)]
        self.assertLess(len(self.t.refine(polygon=[corners, hole], error=5, clip=True).faces), asked)
        with self.assertRaises(ptin.InvalidArgument):
            self.t.refine(window, polygon=corners)
        far = [(xmin - 9, ymin - 9), (xmin - 8, ymin - 9), (xmin - 8, ymin - 8), (xmin - 9, ymin - 9)]
        feature = {"type": "Feature", "geometry": geojson}
        wkt = f"POLYGON(({', '.join(f'{x} {y}' for x, y in corners)}))"
        with open("area.geojson", "w") as file:  # without a CRS these are degrees
            crs = {"type": "name", "properties": {"name": "EPSG:32611"}}
            json.dump({"type": "FeatureCollection", "crs": crs, "features": [{**feature, "properties": {}}]}, file)
        with_heights = [(x, y, 5) for x, y in corners]
        multi = {"type": "MultiPolygon", "coordinates": [[corners], [far]]}
        for polygon in (feature, {"type": "FeatureCollection", "features": [feature]}, wkt, "area.geojson", with_heights, multi):
            area = self.t.volume(polygon=polygon, level=0).area.surface
            self.assertAlmostEqual(area, 1e6 + (0.5 if polygon is multi else 0), delta=1e-3)
        masked = np.ma.MaskedArray(corners, False)
        masked[1, 1] = np.ma.masked
        for wrong, told in (
            ({"type": "Point", "coordinates": [0, 0]}, "this is a Point"),
            ("nowhere.gpkg", "no such file"),
            (masked, "masked"),
            ([[(0, 0, 0, 0)] * 3], "shape"),
        ):
            with self.assertRaisesRegex(ptin.Error, told):
                self.t.volume(polygon=wrong)
        with self.assertRaisesRegex(ptin.InvalidArgument, "masked"):
            self.t.profile(masked)

    def test_a_process_that_only_asks_reads_polygons_of_files(self):
        with open("triangle.geojson", "w") as file:
            file.write('{"type": "Polygon", "coordinates": [[[-118.32, 34.36], [-118.30, 34.36], [-118.30, 34.38], [-118.32, 34.36]]]}')
        asked = (
            f"import sys; sys.path.insert(0, {os.path.dirname(os.path.dirname(ptin.__file__))!r}); import ptin\n"
            "print(round(ptin.open('dem.ptin').volume(polygon='triangle.geojson').area.surface / 1e3))"
        )
        done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr), ("2040\n", ""))

    def test_regions_of_another_crs_are_where_they_are(self):
        west, south, east, north = degrees = (-118.32, 34.36, -118.30, 34.38)
        corners = [(west, south), (east, south), (east, north), (west, north)]
        there = self.t.volume(window=degrees, crs=4326).area.surface
        self.assertAlmostEqual(there, 1838.9 * 2218.6, delta=2e3)  # lengths of these arcs on the ellipsoid
        self.assertEqual(self.t.volume(polygon=corners, crs="EPSG:4326").area.surface, there)
        layer = mock.Mock(crs=4326, __geo_interface__={"type": "Polygon", "coordinates": [corners]}, spec=[])
        self.assertEqual(self.t.volume(polygon=layer).area.surface, there)
        line = self.t.profile([(west, south), (east, north)], crs=4326)
        ends = self.t.locate([(west, south), (east, north)], crs=4326)
        np.testing.assert_array_equal(line.z[[0, -1]], ends.z)
        with self.assertWarnsRegex(UserWarning, "as longitude and latitude some would"):
            self.assertEqual(self.t.volume(window=degrees).area.surface, 0)
        with self.assertRaisesRegex(ptin.InvalidArgument, "a crs is that of"):
            self.t.volume(crs=4326)
        for wrong in (4326.5, {"init": "epsg:4326"}, True):
            with self.assertRaisesRegex(ptin.InvalidArgument, "a CRS is text"):
                self.t.volume(window=degrees, crs=wrong)

    def test_polygons_that_overlap_are_one_area(self):
        try:
            from shapely.geometry import MultiPolygon, box
        except ImportError:
            self.skipTest("needs shapely")
        a, b = box(378000, 3803000, 379000, 3804000), box(378500, 3803000, 379500, 3804000)
        with self.assertRaisesRegex(ptin.InvalidArgument, "not valid"):
            self.t.volume(polygon=MultiPolygon([a, b]))
        both = {"type": "GeometryCollection", "geometries": [a.__geo_interface__, b.__geo_interface__]}
        self.assertAlmostEqual(self.t.volume(polygon=both).area.surface, 1.5e6, delta=1e-3)
        self.assertEqual(len(self.t.profile(a.exterior.coords).z), len(self.t.profile(list(a.exterior.coords)).z))

    def test_parts_are_the_mesh(self):
        whole = self.t.refine(error=5)

        def triangles(mesh):
            return {tuple(sorted(map(tuple, mesh.vertices[face]))) for face in mesh.faces}

        parts = list(self.t.parts(error=5, memory="3M"))
        self.assertGreater(len(parts), 3)
        self.assertEqual(sum(len(part.faces) for part in parts), len(whole.faces))
        self.assertEqual(set().union(*map(triangles, parts)), triangles(whole))
        for part in parts:
            self.assert_certified(part, 5)
        for first in self.t.parts(error=5, memory="3M"):
            break  # the rest is given up

    def test_raster_of_the_source_is_the_source(self):
        r = self.t.raster(error=None)
        array, transform, crs = r
        self.assert_array(array, (257, 257), "f8")
        self.assert_certified(r, None)
        self.assertEqual(crs, "EPSG:32611")
        filled = self.t.raster(size=(257, 257), error=None)
        np.testing.assert_array_equal(filled.array, array)
        np.testing.assert_allclose(filled.transform, transform, rtol=1e-12)
        rows, columns = np.mgrid[0:257:16, 0:257:16].reshape(2, -1)
        xy = np.column_stack([transform.c + (columns + 0.5) * 30, transform.f - (rows + 0.5) * 30])
        np.testing.assert_array_equal(self.t.locate(xy).z, array[rows, columns])

    def test_raster_of_other_pixels(self):
        fine = self.t.raster(size=(64, 32))
        self.assert_array(fine.array, (32, 64), "f8")
        self.assertFalse(np.isnan(fine.array).any())
        self.assertFalse(fine.exact)
        self.assert_certified(self.t.raster(size=(64, 32), error=3.0), 3)
        window = (378000, 3803000, 379000, 3804000)
        self.assertEqual(self.t.raster(window, pixel_size=100).array.shape, (10, 10))
        self.assertEqual(self.t.raster(window, size=(40, 20)).transform, (25, 0, 378000, 0, -50, 3804000))
        for wrong in ({"size": (0, 3)}, {"size": (2, 2), "pixel_size": 3}, {"pixel_size": -1}, {"error": "fine"}):
            with self.assertRaises(ptin.InvalidArgument):
                self.t.raster(**wrong)

    def test_isolines(self):
        for error in (None, 10.0):
            lines = self.t.isolines(interval=100, error=error)
            self.assert_array(lines.coords, (lines.offsets[-1], 2), "f8")
            self.assert_array(lines.offsets, (len(lines) + 1,), "i8")
            self.assert_array(lines.level, (len(lines),), "f8")
            self.assert_array(lines.ring, (len(lines),), "?")
            self.assert_certified(lines, error)
        for line, level, ring in zip(lines.lines(), lines.level, lines.ring):
            self.assertEqual(np.array_equal(line[0], line[-1]), bool(ring))
        exact = self.t.isolines(levels=[1000])
        np.testing.assert_allclose(self.t.locate(exact.coords).z, 1000, atol=1e-3)
        self.assertEqual(len(self.t.isolines(levels=[9000])), 0)
        self.assertEqual(len(self.t.isolines(interval=9000, base=100)), 0)
        with self.assertRaises(ptin.InvalidArgument):
            self.t.isolines()

    def test_isolines_go_to_shapely_and_geopandas(self):
        lines = self.t.isolines(interval=200)
        try:
            shapes = lines.to_shapely()
        except ImportError:
            self.skipTest("needs shapely")
        self.assertEqual(len(shapes), len(lines))
        np.testing.assert_array_equal(np.asarray(shapes[3].coords), list(lines.lines())[3])
        try:
            frame = lines.to_geopandas()
        except ImportError:
            self.skipTest("needs geopandas")
        self.assertEqual((len(frame), frame.crs.to_epsg()), (len(lines), 32611))

    def test_highest(self):
        top = self.t.highest(listed=3)
        self.assertEqual(top.point.height, self.t.height_range[1])
        self.assert_array(top.vertices, (3, 3), "f8")
        self.assert_certified(top, None)
        self.assertEqual(self.t.highest(lowest=True).point.height, self.t.height_range[0])
        about = self.t.highest(error=20)
        self.assertTrue(about.height_min <= top.point.height <= about.height_max)
        with self.assertWarnsRegex(UserWarning, "misses the terrain"):
            outside = self.t.highest(window=(0, 0, 1, 1))
        self.assertEqual((outside.state, outside.point), ("outside", None))
        self.assertTrue(np.isnan(outside.height_min) and np.isnan(outside.height_max))

    def test_sight_and_viewshed(self):
        hidden = self.t.sight(*EYES)
        self.assertEqual((hidden.verdict, hidden.ends, hidden.exact), ("hidden", ("surface", "surface"), True))
        self.assertLess(hidden.clearance.max, 0)
        self.assertGreater(hidden.obstruction.distance, 0)
        high = self.t.sight((*EYES[0][:2], 3000), (*EYES[1][:2], 3000), absolute=True, frequency=450e6)
        self.assertEqual((high.verdict, high.obstruction), ("visible", None))
        self.assertGreater(high.fresnel_ratio, 1)
        seen = self.t.viewshed(EYES[0], radius=1500)
        array, transform, crs = seen
        self.assert_array(array, array.shape, "u1")
        self.assert_certified(seen, None)
        self.assertEqual((seen.visible, seen.hidden), ((array == 255).sum(), (array == 0).sum()))
        self.assertGreater(self.t.viewshed(EYES[0], radius=1500, error=20).undecided, 0)
        row, column = np.argwhere(array == 255)[7]
        xy = (transform.c + (column + 0.5) * transform.a, transform.f + (row + 0.5) * transform.e)
        self.assertEqual(self.t.sight(EYES[0], (*xy, 0)).verdict, "visible")

    def test_volume(self):
        v = self.t.volume(level=1000)
        self.assert_certified(v, None)
        self.assertEqual((v.level, v.net.volume), (1000, v.cut.volume - v.fill.volume))
        about = self.t.volume(level=1000, error=20)
        self.assertTrue(about.net.low <= v.net.volume <= about.net.high)
        several = self.t.volume(level=[900, 1000])
        self.assertEqual((several[0].level, several[1].cut), (900, v.cut))
        same = self.t.volume(against="dem.ptin")
        self.assertEqual((same.level, same.cut.volume, same.fill.volume), (None, 0, 0))
        self.assertEqual(same.area.surface, v.area.surface)


class Program(OnTerrain):
    """The answers are those that the program tells."""

    def test_locate(self):
        for detail, error in (([], None), (["--error", 5], 5)):
            json_answer = told("locate", "dem.ptin", 378000, 3804000, *detail)
            h = self.t.locate((378000, 3804000), error=error)
            point = json_answer["points"][0]
            self.assertEqual((h.z, h.low, h.high), tuple(point[k] for k in ("height", "height_min", "height_max")))
            for key in ("certified_error", "certified_deviation", "exact"):
                self.assertEqual(getattr(h, key), json_answer[key])
            self.assertEqual(self.t.border_moved_at_most(h.certified_error), json_answer["border_moved_at_most"])

    def test_profile(self):
        line = "LINESTRING(377000 3804000, 379000 3805000)"
        json_answer = told("profile", "dem.ptin", "--line", line, "--stations", 100, "--error", 5)
        p = self.t.profile([(377000, 3804000), (379000, 3805000)], stations=100, error=5)
        for name, array in (("distance", p.distance), ("height", p.z), ("x", p.xy[:, 0]), ("station", p.station)):
            self.assertEqual([point[name] for point in json_answer["points"]], array.tolist())
        self.assertEqual(json_answer["length"], p.distance[-1])

    def test_isolines(self):
        json_answer = told("isoline", "dem.ptin", "--interval", 100, "--error", 5, "-o", "lines.geojson")
        lines = self.t.isolines(interval=100, error=5)
        self.assertEqual(json_answer["levels"], np.unique(lines.level).tolist())
        told_counts = [json_answer[key] for key in ("lines", "rings", "points")]
        self.assertEqual(told_counts, [len(lines), lines.ring.sum(), len(lines.coords)])

    def test_highest(self):
        json_answer = told("highest", "dem.ptin", "-k", 5, "--error", 10)
        top = self.t.highest(listed=5, error=10)
        self.assertEqual(json_answer["state"], top.state)
        self.assertEqual([json_answer["point"][key] for key in ("x", "y", "height")], list(top.point))
        for key in ("height_min", "height_max", "at_vertex"):
            self.assertEqual(json_answer["point"][key], getattr(top, key))
        vertices = [[vertex[key] for key in ("x", "y", "height")] for vertex in json_answer["vertices"]]
        self.assertEqual(vertices, top.vertices.tolist())

    def test_sight_and_volume(self):
        ends = [number for end in EYES for number in end]
        json_answer = told("sight", "dem.ptin", *ends)
        s = self.t.sight(*EYES)
        place = [json_answer["obstruction"][key] for key in ("x", "y", "distance", "height")]
        self.assertEqual((json_answer["length"], place), (s.length, list(s.obstruction)))
        self.assertEqual(json_answer["clearance"]["min"], s.clearance.min)
        json_answer = told("volume", "dem.ptin", "--level", 1000, "--error", 5)
        v = self.t.volume(level=1000, error=5)
        for key in ("cut", "fill", "net"):
            self.assertEqual(json_answer[key], getattr(v, key)._asdict())
        self.assertEqual(json_answer["area"], v.area._asdict())

    def test_facts(self):
        info = told("info", "dem.ptin")
        self.assertEqual(tuple(info["bounds"][key] for key in ("min_x", "min_y", "max_x", "max_y")), self.t.bounds)
        self.assertEqual((info["heights"]["min"], info["heights"]["max"]), self.t.height_range)
        self.assertEqual((info["source_samples"], info["vertices"]), (self.t.samples, self.t.vertices))
        self.assertEqual((info["crs"]["code"], info["crs"]["wkt"]), (self.t.crs, self.t.wkt))


class Errors(OnTerrain):
    def test_exceptions_are_pythons_own_too(self):
        with self.assertRaises(FileNotFoundError) as raised:
            ptin.open("nothing.ptin")
        self.assertIsInstance(raised.exception, ptin.NotFound)
        self.assertEqual((raised.exception.code, raised.exception.context), ("not_found", "nothing.ptin"))
        for wrong in (lambda: self.t.highest(window=(0, 0, 1)), lambda: self.t.locate((0, 0), error=-1)):
            with self.assertRaises(ValueError) as raised:
                wrong()
            self.assertIsInstance(raised.exception, ptin.InvalidArgument)
        with self.assertRaises(MemoryError) as raised:
            self.t.refine(memory=1000)
        self.assertIsInstance(raised.exception, ptin.ResourceExhausted)
        with open("dem.ptin", "rb") as whole, open("damaged.ptin", "wb") as damaged:
            data = bytearray(whole.read())
            data[200_000:1_000_000] = bytes(800_000)
            damaged.write(data)
        with self.assertRaises(OSError) as raised:
            ptin.open("damaged.ptin").refine()
        self.assertIsInstance(raised.exception, ptin.Corruption)

    def test_a_refusal_names_arguments_and_no_options(self):
        with self.assertRaises(ptin.InvalidArgument) as raised:
            ptin.build(RASTER, "never.ptin", max_edge=3.0)
        self.assertIn("max_edge is for", str(raised.exception))
        self.assertNotIn("--", str(raised.exception))

    def test_a_raster_keeps_within_its_memory(self):
        with self.assertRaisesRegex(ptin.ResourceExhausted, "the array alone takes 80000000000 bytes"):
            self.t.raster(size=(100_000, 100_000))
        for side in (2_000_000, 2**31 - 1):
            with self.assertRaises(ptin.ResourceExhausted):
                self.t.raster(size=(side, side), memory=2.0**62)
        with self.assertRaises(ptin.ResourceExhausted):
            self.t.raster(size=(4000, 4000), memory="64M")
        self.assertEqual(self.t.raster(size=(1000, 1000), memory="64M").array.shape, (1000, 1000))

    def test_the_child_of_a_fork_has_no_parts(self):
        for is_waiting in (False, True):
            parts = self.t.parts(error=1, memory="4M")
            next(parts)
            if is_waiting:
                time.sleep(0.5)  # until the next part is made
            child = os.fork()
            if child == 0:
                signal.alarm(30)
                is_right = False
                try:
                    next(parts)
                except ptin.InvalidArgument as refused:
                    is_right = "before the process forked" in str(refused)
                    del parts
                    is_right = is_right and len(list(self.t.parts(error=20, memory="4M"))) > 0
                finally:
                    os._exit(0 if is_right else 1)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
            self.assertGreater(len(list(parts)), 0)

    def test_what_is_no_number_is_said_so(self):
        with self.assertRaisesRegex(TypeError, "an error is a number"):
            self.t.refine(error="5")
        for wrong in (0.5, -1, 2**63, "many", float("nan")):
            with self.assertRaisesRegex(ptin.InvalidArgument, "vertices is a whole number"):
                self.t.refine(vertices=wrong)
        self.assertEqual(len(self.t.refine(vertices=np.float32(500)).vertices), 500)
        with self.assertRaisesRegex(ptin.InvalidArgument, "columns and rows"):
            self.t.raster(size=500)
        with self.assertRaisesRegex(ptin.InvalidArgument, "a pixel_size is"):
            self.t.raster(pixel_size=(1, 2, 3))
        self.assertEqual(len(self.t.highest(listed=2**62).vertices), 66049)
        levels = self.t.isolines(levels=(level for level in (1000, 1100)), error=20).level
        self.assertEqual(np.unique(levels).tolist(), [1000, 1100])
        with self.assertRaisesRegex(TypeError, "real numbers"):
            self.t.locate(np.array([[1j, 2]]))
        self.assertEqual(ptin.open(b"dem.ptin").samples, self.t.samples)

    def test_shapes_and_types_are_looked_at(self):
        with self.assertRaises(ptin.InvalidArgument):
            self.t.locate(np.zeros((3, 3)))
        for wrong in ("text", [["a", "b"]], None):
            with self.assertRaises((TypeError, ValueError)):
                self.t.locate(wrong)

    def test_numbers_of_numpy_are_numbers(self):
        for memory in (0.5 * (1 << 30), np.int64(1 << 29), np.float32(1 << 29), "0.5G"):
            self.assertEqual(ptin.open("dem.ptin", memory=memory)._memory, 1 << 29)
        for wrong in (-1, float("nan"), float("inf"), [1], "much"):
            with self.assertRaisesRegex(ptin.InvalidArgument, "no size of memory"):
                ptin.open("dem.ptin", memory=wrong)

    def test_a_window_is_four_numbers(self):
        for wrong in ((1, 2, 3), 5, np.zeros((2, 2))):
            with self.assertRaisesRegex(ptin.InvalidArgument, "four numbers"):
                self.t.refine(window=wrong)

    def test_isolines_need_no_temporary_folder(self):
        count = len(self.t.isolines(interval=100))
        with mock.patch.dict(os.environ, TMPDIR="/nowhere/at/all"):
            self.assertEqual(len(self.t.isolines(interval=100)), count)

    def test_a_closed_terrain_answers_no_more(self):
        with ptin.open("dem.ptin") as t:
            pass
        with self.assertRaisesRegex(ValueError, "closed"):
            t.locate((0, 0))


class Elsewhere(OnTerrain):
    """Files that a server has."""

    def setUp(self):
        super().setUp()
        self.server = subprocess.Popen(
            [sys.executable, os.path.join(ROOT, "tests/support/range_server.py"), "."],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.host = f"http://127.0.0.1:{int(self.server.stdout.readline())}"

    def tearDown(self):
        self.server.communicate()

    def test_a_url_is_asked_as_a_file(self):
        xy = positions(self.t, 30)
        with ptin.open(f"{self.host}/plain/dem.ptin") as there:
            np.testing.assert_array_equal(there.locate(xy, error=5).z, self.t.locate(xy, error=5).z)
            again = pickle.loads(pickle.dumps(there))
            self.assertEqual(again.locate(xy[0]).z, self.t.locate(xy[0]).z)
        with self.assertRaises(ptin.NotFound):
            ptin.open(f"{self.host}/missing/dem.ptin")
        with self.assertRaises(FileNotFoundError) as raised:
            ptin.open("missing.ptin")
        self.assertEqual((raised.exception.errno, raised.exception.filename), (errno.ENOENT, "missing.ptin"))
        self.assertIn("missing.ptin", str(raised.exception))

    def test_a_silent_server_is_given_up(self):
        with self.assertRaisesRegex(ptin.IoError, "silent"):
            ptin.open(f"{self.host}/silent/dem.ptin", timeout=1).refine()
        with self.assertRaisesRegex(ptin.InvalidArgument, "above 0"):
            ptin.open("dem.ptin", timeout=0)

    def test_a_fork_opens_it_anew(self):
        xy = positions(self.t, 200)
        expected = self.t.locate(xy).z
        with ptin.open(f"{self.host}/plain/dem.ptin") as there:
            there.locate(xy[0])
            of_parent = there._opened
            child = os.fork()
            if child == 0:
                signal.alarm(60)
                is_right = False
                try:
                    is_right = np.array_equal(there.locate(xy).z, expected) and there._opened is not of_parent
                finally:
                    os._exit(0 if is_right else 1)
            np.testing.assert_array_equal(there.locate(xy).z, expected)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
            self.assertIs(there._opened, of_parent)

    def test_ctrl_c_ends_waiting_for_a_server(self):
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            ptin.open(f"{self.host}/silent/dem.ptin").refine()
        there = ptin.open(f"{self.host}/plain/dem.ptin")
        there._opened.stop_waiting()  # as a signal does, for good; what is asked next opens it anew
        self.assertEqual(there.locate((380000, 3804000)).z, self.t.locate((380000, 3804000)).z)


# What a process does that ends while daemon threads are in questions, one of them in each kind of waiting.
DAEMONS = """
import sys, threading
sys.path.insert(0, sys.argv[1])
import numpy as np
import ptin

t = ptin.open("dem.ptin")
one = (378000.0, 3804000.0)
many = np.random.default_rng(1).random((400_000, 2)) * 3000 + one
rounds = [
    lambda: t.locate(one),
    lambda: t.locate(many),
    lambda: t.refine(error=1),
    lambda: next(t.parts(error=5, memory="3M")),
    lambda: ptin.build(sys.argv[2], "daemon.ptin", progress=lambda *told: None, overwrite=True, discard=True),
]

def repeat(work, begun):
    while True:
        try:
            work()
        except Exception as error:  # as services do; the end of Python is none
            print(error, file=sys.stderr)
        begun.set()

events = [threading.Event() for work in rounds]
for work, begun in zip(rounds, events):
    threading.Thread(target=repeat, args=(work, begun), daemon=True).start()
for begun in events:
    begun.wait()
"""


class Process(OnTerrain):
    """What the module does to the process: threads, signals, memory."""

    def test_terrains_are_pickled_by_path(self):
        there = pickle.loads(pickle.dumps(ptin.open("dem.ptin", memory="1G")))
        os.makedirs("elsewhere", exist_ok=True)
        os.chdir("elsewhere")
        try:
            self.assertEqual(there.highest().point, self.t.highest().point)
        finally:
            os.chdir("..")

    def test_other_threads_run_while_a_question_is_answered(self):
        begun, asked, ran = threading.Event(), threading.Lock(), threading.Event()

        def run():
            begun.set()
            with asked:
                ran.set()

        xy = positions(self.t, 200_000)
        before = sys.getswitchinterval()
        sys.setswitchinterval(1000)  # a thread runs until it waits, so the other one waits when it has begun
        other = threading.Thread(target=run)
        asked.acquire()
        try:
            other.start()
            begun.wait()
            asked.release()
            self.assertFalse(ran.is_set())
            for _ in range(100):
                self.t.locate(xy)
                if ran.is_set():
                    break
            self.assertTrue(ran.is_set())
        finally:
            sys.setswitchinterval(before)
            other.join()

    def test_a_process_ends_while_daemon_threads_ask(self):
        package = os.path.dirname(os.path.dirname(ptin.__file__))
        done = subprocess.run([sys.executable, "-c", DAEMONS, package, RASTER], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_threads_ask_one_terrain(self):
        xy = positions(self.t, 20_000)
        expected = self.t.locate(xy).z
        answers = [None] * 4

        def ask(i):
            answers[i] = self.t.locate(xy).z

        threads = [threading.Thread(target=ask, args=(i,)) for i in range(len(answers))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for answer in answers:
            np.testing.assert_array_equal(answer, expected)

    def test_ctrl_c_ends_a_question(self):
        xy = positions(self.t, 400_000)
        timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            while True:
                self.t.locate(xy)
        self.assertEqual(self.t.locate(xy[0]).state, ptin.State.SURFACE)

    def test_ctrl_c_ends_a_build(self):
        seen = threading.Event()

        def handler(number, frame):
            seen.set()
            raise KeyboardInterrupt

        def progress(stage, done, total):
            if not seen.is_set():
                os.kill(os.getpid(), signal.SIGINT)
                seen.wait(60)

        before = signal.signal(signal.SIGINT, handler)
        try:
            with self.assertRaises(KeyboardInterrupt):
                ptin.build(RASTER, "stopped.ptin", progress=progress)
        finally:
            signal.signal(signal.SIGINT, before)
        self.assertEqual(ptin.build(RASTER, "stopped.ptin", discard=True, overwrite=True).samples, 66049)

    def test_a_build_of_an_array_leaves_nothing(self):
        def progress(stage, done, total):
            """Raises when a part of the work is written down, which is done every two seconds."""
            time.sleep(0.3)
            for path in glob.glob(".array_stopped.ptin.ptin-build/manifest"):
                with open(path, "rb") as manifest:
                    if b"checkpoint" in manifest.read():
                        raise KeyError(stage)

        array, transform = source()
        with self.assertRaises(KeyError):
            ptin.build(np.tile(array, (4, 4)), "array_stopped.ptin", transform=transform, tile=256, progress=progress)
        self.assertEqual([name for name in os.listdir(".") if "array_stopped" in name], [])
        # What another build has left stays where this one was refused before it began.
        with self.assertRaises(KeyError):
            ptin.build(large_file(np.tile(array, (4, 4))), "array_stopped.ptin", tile=256, progress=progress)
        for options in ({"colour": "red"}, {"memory": "1M"}, {"tile": -1}):
            with self.assertRaises((TypeError, ptin.Error)):
                ptin.build(array, "array_stopped.ptin", transform=transform, **options)
            self.assertTrue(os.path.exists(".array_stopped.ptin.ptin-build/manifest"))
        report = ptin.build(array, "array_stopped.ptin", transform=transform)
        self.assertEqual((report.samples, os.path.exists(".array_stopped.ptin.ptin-build")), (66049, False))

    def test_nothing_leaks(self):
        window = (378000, 3803000, 379000, 3804000)
        outside, xy = (-1.0, -1.0), positions(self.t, 1500)

        def ask_all(times):
            for _ in range(times):
                self.t.locate(xy, error=5)
                self.t.refine(window, error=20, clip=True)
                self.t.raster(window, size=(20, 20))
                self.t.isolines(interval=100, window=window)
                self.t.profile(xy[:3], error=20)
                self.t.highest(window)
                for part in self.t.parts(error=50):
                    break
                try:
                    self.t.locate(outside, error=-1)
                except ptin.InvalidArgument:
                    pass

        def resident():
            with open("/proc/self/statm") as statm:
                return int(statm.read().split()[1]) * resource.getpagesize()

        ask_all(20)
        for _ in range(20_000):
            self.t.locate(outside)
        before = resident()
        for _ in range(100_000):
            self.t.locate(outside)
        ask_all(100)
        self.assertLess(resident() - before, 8 << 20)


class Install(unittest.TestCase):
    def test_the_component_is_a_package(self):
        subprocess.run(
            ["cmake", "--install", BUILD, "--component", "python", "--prefix", "installed"], check=True, stdout=subprocess.DEVNULL
        )
        (package,) = glob.glob("installed/lib/python3*/*-packages")
        self.assertTrue(os.path.exists(f"{package}/ptin/py.typed"))
        asked = "import ptin; print(ptin.__file__, ptin.__version__, ptin.open('dem.ptin').samples)"
        environment = {**os.environ, "PYTHONPATH": package}
        done = subprocess.run([sys.executable, "-c", asked], env=environment, check=True, capture_output=True, text=True)
        self.assertEqual(done.stdout.split()[1:], [ptin.__version__, "66049"])
        self.assertIn("installed", done.stdout)


class Build(unittest.TestCase):
    def test_progress_is_told(self):
        calls = []
        ptin.build(RASTER, "told.ptin", progress=lambda *call: calls.append(call))
        self.assertTrue(all(0 <= done <= total for _, done, total in calls))
        self.assertIn("collapsing", {stage for stage, _, _ in calls})

    def test_what_progress_raises_comes_out(self):
        def progress(stage, done, total):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            ptin.build(RASTER, "raised.ptin", progress=progress)
        self.assertFalse(os.path.exists("raised.ptin"))

    def test_files_come_from_an_iterator(self):
        self.assertEqual(ptin.build(iter([RASTER]), "iterator.ptin").samples, 66049)
        points = os.path.join(ROOT, "tests/data/ground_points.csv")
        with self.assertRaisesRegex(ptin.NotFound, "nothing.geojson"):
            ptin.build(points, "never.ptin", breaklines=iter(["nothing.geojson"]))
        with self.assertRaisesRegex(ptin.InvalidArgument, "one array"):
            ptin.build(iter([np.zeros((3, 3))]), "never.ptin")

    def test_a_bar_for_each_stage(self):
        try:
            importlib.import_module("tqdm")
        except ImportError:
            with self.assertRaises(ImportError):
                ptin.build(RASTER, "bar.ptin", progress=True)
            self.skipTest("needs tqdm")
        ptin.build(RASTER, "bar.ptin", progress=True)

    def test_a_grid_is_built_as_its_file(self):
        array, transform = source()
        for dtype in ("float32", "float64", "int16", "int32", "uint16", "uint32"):
            report = ptin.build(
                array.astype(dtype), f"{dtype}.ptin", transform=transform, a_srs="EPSG:32611", vertical_crs="EPSG:5773"
            )
            self.assertEqual((report.samples, report.void_samples, report.warnings), (66049, 0, []))
            with ptin.open(f"{dtype}.ptin") as t:
                self.assertEqual((t.crs, t.bounds), ("EPSG:32611", ptin.open("dem.ptin").bounds))
                np.testing.assert_array_equal(t.raster(error=None).array, array)
        wide = np.where(array == array.max(), 2**40, array).astype("int64")
        for grid in (array.astype("int64"), array.astype("uint64"), wide, (array / 8).astype("int8").astype("float16")):
            ptin.build(grid, "other.ptin", transform=transform, overwrite=True)
            np.testing.assert_array_equal(ptin.open("other.ptin").raster(error=None).array, grid)
        for wrong in (array.astype("int64") + 2**53, array > 900, array[0], array[:, :, None], array.astype("complex")):
            with self.assertRaises(ptin.InvalidArgument):
                ptin.build(wrong, "wrong.ptin", transform=transform)
        with self.assertRaisesRegex(ptin.InvalidArgument, "six numbers"):
            ptin.build(array, "wrong.ptin", transform=(1, 2))

    def test_the_transform_of_pixels_is_one(self):
        grid = np.arange(12.0).reshape(3, 4)
        report = ptin.build(grid, "pixels.ptin", transform=(1, 0, 0, 0, 1, 0), a_srs="EPSG:32611")
        t = ptin.open("pixels.ptin")
        self.assertEqual((report.warnings, t.bounds), ([], (0.5, 0.5, 3.5, 2.5)))
        self.assertEqual(t.locate((3.5, 0.5)).z, grid[0, 3])

    def test_what_is_no_source_is_said_so(self):
        frame = mock.Mock(spec=["__array__"])
        for wrong, told in ((frame, "numpy.asarray"), ([[1, 2, 3]], "lists of numbers"), (5, "a int is no source")):
            with self.assertRaisesRegex(ptin.InvalidArgument, told):
                ptin.build(wrong, "never.ptin")
        with self.assertRaisesRegex(ptin.InvalidArgument, "threads"):
            ptin.build(RASTER, "never.ptin", threads=-1)

    def test_what_was_meant_otherwise_is_warned_of(self):
        with self.assertWarnsRegex(UserWarning, "^the array: the stored value -32768 .* build with nodata -32768"):
            ptin.build(np.full((5, 5), -32768.0), "warned.ptin", transform=(1, 0, 0, 0, -1, 0), overwrite=True)

    def test_voids_of_a_grid(self):
        array, transform = source()
        array = array.astype("float32")
        holes = np.zeros(array.shape, dtype=bool)
        holes[100:120, 50:90] = True
        with_nan = np.where(holes, np.float32(np.nan), array)
        masked = np.ma.MaskedArray(array, holes)
        whole = np.ma.MaskedArray(array.astype("int16"), holes)
        taken = np.ma.MaskedArray(array.astype("uint16"), holes, fill_value=int(array[0, 0]))
        taken[0, 1] = 0
        for name, grid, options in (
            ("nan", with_nan, {}),
            ("masked", masked, {}),
            ("masked floats", masked, {"nodata": 1e20}),
            ("masked integers", whole, {}),
            ("masked integers of all kinds", taken, {}),
            ("masked integers and nodata", whole, {"nodata": -9999}),
            ("nodata", np.where(holes, -1, array).astype("int16"), {"nodata": -1}),
            ("turned", with_nan[::-1], {}),
        ):
            steps = transform if name != "turned" else (30, 0, transform.c, 0, 30, transform.f - 257 * 30)
            report = ptin.build(grid, f"{name}.ptin", transform=steps, **options)
            self.assertEqual(report.void_samples, 800)
            np.testing.assert_array_equal(np.isnan(ptin.open(f"{name}.ptin").raster(error=None).array), holes)
        for nodata in (-99999, 0.5, np.nan):
            with self.assertRaisesRegex(ptin.InvalidArgument, "int16 cannot hold"):
                ptin.build(whole, "never.ptin", transform=transform, nodata=nodata)

    def test_no_source_is_its_output(self):
        shutil.copy(RASTER, "own.tif")
        os.symlink("own.tif", "link.tif")
        with open("own.tif", "rb") as file:
            before = file.read()
        for source, output in (("own.tif", "own.tif"), ("link.tif", "own.tif"), ("own.tif", os.path.abspath("link.tif"))):
            with self.assertRaisesRegex(ptin.InvalidArgument, "would destroy it"):
                ptin.build(source, output, overwrite=True)
        with open("own.tif", "rb") as file:
            self.assertEqual(file.read(), before)

    def test_classes_are_numbers_ranges_and_names(self):
        path = os.path.join(ROOT, "tests/data/ground_points.csv")  # which has none, as is seen once they are read
        for classes in (2, np.uint8(2), [2, 9], (2, 9), np.array([2, 9]), "2,8-10", "!noise", ["ground", 9]):
            with self.assertRaisesRegex(ptin.InvalidArgument, "only LAS has classes"):
                ptin.build(path, "classes.ptin", classes=classes)
        for wrong in (256, "grund", [2, "9-"], 2.5, [None]):
            with self.assertRaisesRegex(ptin.InvalidArgument, "is no class of LAS|is no value of the option"):
                ptin.build(path, "classes.ptin", classes=wrong)

    def test_points_are_built_as_their_file(self):
        path = os.path.join(ROOT, "tests/data/ground_points.csv")
        points = np.loadtxt(path, delimiter=",", skiprows=1)[:, :3]
        ptin.build(path, "file.ptin")
        report = ptin.build(points, "array.ptin")
        with ptin.open("file.ptin") as of_file, ptin.open("array.ptin") as of_array:
            self.assertEqual(report.samples, of_file.samples)
            self.assertEqual(of_file.bounds, of_array.bounds)
            xy = positions(of_file, 500)
            np.testing.assert_array_equal(of_file.locate(xy).z, of_array.locate(xy).z)
            with self.assertRaisesRegex(ptin.InvalidArgument, "pixel_size"):
                of_array.raster()
            self.assertEqual(of_array.raster(size=(30, 20)).array.shape, (20, 30))
        masked = np.ma.MaskedArray(points.copy(), False)
        for column in range(3):
            points[column, column] = np.nan
            masked[column, column] = np.ma.masked
        for given, options in ((points, {}), (masked, {}), (masked, {"nodata": -9999})):
            self.assertEqual(ptin.build(given, "array.ptin", overwrite=True, **options).left_out_points, 3)

    def test_equal_arrays_make_equal_files(self):
        array, transform = source()
        grid, points = array[:40, :40], np.argwhere(np.ones((9, 9)))[:, [0, 1, 1]]
        for name, one, options in (("g", grid, {"transform": transform}), ("p", points, {})):
            files = []
            for path in (f"{name}1.ptin", f"{name}2.ptin"):
                ptin.build(one, path, **options)
                with open(path, "rb") as built:
                    files.append(built.read())
            self.assertEqual(*files)

    def test_options_are_those_of_the_program(self):
        report = ptin.build(RASTER, "options.ptin", max_error=5.0, cost="roi", bbox=(377000, 3801000, 380000, 3804000))
        self.assertLess(report.samples, 66049)
        self.assertIn("max_error (float)", ptin.build.__doc__)
        with self.assertRaisesRegex(ptin.InvalidArgument, "none of error, roi"):
            ptin.build(RASTER, "never.ptin", cost="cheap")
        with self.assertRaisesRegex(TypeError, "no option"):
            ptin.build(RASTER, "never.ptin", colour="red")
        with self.assertRaises(ptin.InvalidArgument):
            ptin.build(RASTER, "never.ptin", max_error="much")
        with self.assertRaises(ptin.InvalidArgument):
            ptin.build(RASTER, "options.ptin")


class Documents(unittest.TestCase):
    def test_all_names_are_listed(self):
        there = {name for name, value in vars(ptin).items() if name[0] != "_" and not isinstance(value, types.ModuleType)}
        self.assertEqual(sorted(there), sorted(ptin.__all__))

    def test_examples_of_docstrings(self):
        failed = 0
        for name in ("ptin", "ptin.terrain", "ptin.results", "ptin.construct"):
            module = importlib.import_module(name)
            names = {**vars(module), "np": np, "ptin": ptin, "t": ptin.open("dem.ptin")}
            result = doctest.testmod(module, extraglobs=names)
            failed += result.failed
        self.assertEqual(failed, 0)

    def test_the_page(self):
        """Every block of the page runs, in its order. Where Matplotlib is not installed nothing is drawn; PTIN_PICTURES
        names a folder for what is."""
        try:
            import matplotlib

            matplotlib.use("Agg")
            absent = {}
        except ImportError:
            pyplot = mock.MagicMock()
            pyplot.subplots.return_value = (mock.MagicMock(), mock.MagicMock())
            absent = {"matplotlib": mock.MagicMock(pyplot=pyplot), "matplotlib.pyplot": pyplot}
        for name in ("tqdm", "tqdm.auto", "geopandas", "shapely", "trimesh"):
            try:
                importlib.import_module(name)
            except ImportError:
                absent[name] = mock.MagicMock()
        with open(os.path.join(ROOT, "tools/python/README.md")) as page:
            blocks = page.read().split("```python\n")[1:]
        with open("wells.csv", "w") as wells:
            wells.write("x,y,name\n378000,3804000,a\n380000,3805000,b\n0,0,c\n")
        os.symlink(os.path.join(ROOT, "tests"), "tests")
        with mock.patch.dict(sys.modules, absent):
            names = {}
            for block in blocks:
                exec(compile(block.split("```")[0], "README.md", "exec"), names)
        self.assertGreater(len(blocks), 5)
        for picture in glob.glob("*.png") if "PTIN_PICTURES" in os.environ else ():
            shutil.copy(picture, os.environ["PTIN_PICTURES"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
