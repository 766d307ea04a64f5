#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""GDAL reads terrains by gdal_PTIN.so: through its Python module, by its programs, by other programs that stand on it.

usage: plugin.py PROGRAM DATA PLUGINS SCRATCH [CASE...]

PROGRAM is ptin, DATA the folder tests/data, PLUGINS the folder with gdal_PTIN.so. Status 77, with a message, where GDAL's Python
module is not installed. What stands on GDAL and is not installed (rasterio, MapServer) is passed over with a message.
"""
import os
import shutil
import subprocess
import sys
import unittest

PROGRAM, DATA, PLUGINS, SCRATCH = (os.path.abspath(a) for a in sys.argv[1:5])
os.environ["GDAL_DRIVER_PATH"] = PLUGINS  # before GDAL is loaded
try:
    import numpy
    from osgeo import gdal, ogr, osr
except ImportError as e:
    print("skipped: GDAL's Python module is not installed:", e)
    sys.exit(77)

gdal.DontUseExceptions()
RANGE_SERVER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support/range_server.py")
KEPT = []


def run(*command, status=0):
    """Standard output and error of a program."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=SCRATCH, check=False)
    if done.returncode != status:
        raise AssertionError(f"{' '.join(command)}\nended with {done.returncode}\n{done.stdout}")
    return done.stdout


def scratch(name):
    return os.path.join(SCRATCH, name)


def source(name):
    return os.path.join(DATA, name + "_257.tif")


def terrain(name):
    """A small real terrain, built once."""
    path = scratch(name + ".ptin")
    if not os.path.exists(path):
        given = os.path.join(DATA, "ground_points.csv") if name == "points" else source(name)
        run(PROGRAM, "build", given, "-o", path, "-q")
    return path


def write(name, values, place, projection):
    """A raster for `build`."""
    data = gdal.GetDriverByName("GTiff").Create(scratch(name + ".tif"), values.shape[1], values.shape[0], 1, gdal.GDT_Float32)
    data.SetGeoTransform(place)
    data.SetProjection(projection)
    data.GetRasterBand(1).WriteArray(values)


def build(name):
    """The terrain of what was written."""
    run(PROGRAM, "build", name + ".tif", "-o", name + ".ptin", "--overwrite", "-q")
    return scratch(name + ".ptin")


def opened(path, *options):
    """A data set that stays open until the case ends: its bands and layers do not keep it."""
    KEPT.append(gdal.OpenEx(path, gdal.OF_RASTER | gdal.OF_VECTOR | gdal.OF_READONLY, open_options=list(options)))
    return KEPT[-1]


def heights(path, *options, **window):
    return opened(path, *options).ReadAsArray(**window)


def failure(work):
    """What `work` gives, and GDAL's last message."""
    gdal.ErrorReset()
    gdal.PushErrorHandler("CPLQuietErrorHandler")
    try:
        return work(), gdal.GetLastErrorMsg()
    finally:
        gdal.PopErrorHandler()


def statistics(path):
    """Size, least and largest value of a raster that a program wrote."""
    data = gdal.Open(path)
    array = data.ReadAsArray()
    array = array[array != data.GetRasterBand(1).GetNoDataValue()]
    return data.RasterXSize, data.RasterYSize, array.min(), array.max()


class Case(unittest.TestCase):
    def tearDown(self):
        KEPT.clear()


class Raster(Case):
    def test_full_resolution_is_the_source(self):
        for name, lone in ("mountains", 0), ("coast", 4):  # which no triangle of the source touches
            a, b = opened(source(name)), opened(terrain(name))
            self.assertEqual(a.GetGeoTransform(), b.GetGeoTransform())
            self.assertTrue(a.GetSpatialRef().IsSame(b.GetSpatialRef()))
            there = a.ReadAsArray() != (a.GetRasterBand(1).GetNoDataValue() or -32768)
            ours = b.ReadAsArray() != b.GetRasterBand(1).GetNoDataValue()
            self.assertEqual(numpy.count_nonzero(there & ~ours), lone)
            self.assertFalse((ours & ~there).any())
            self.assertTrue((a.ReadAsArray()[ours] == b.ReadAsArray()[ours]).all())

    def test_tenths_are_read_without_rounding(self):
        values = numpy.arange(40 * 30, dtype=float).reshape(30, 40) ** 2
        data = gdal.GetDriverByName("GTiff").Create(scratch("tenths.tif"), 40, 30, 1, gdal.GDT_Float64)
        data.SetGeoTransform([0, 1, 0, 30, 0, -1])
        data.GetRasterBand(1).WriteArray(values)
        data.GetRasterBand(1).SetScale(0.1)
        del data
        run(PROGRAM, "build", "tenths.tif", "-o", "tenths.ptin", "-q")
        band = opened(scratch("tenths.ptin")).GetRasterBand(1)
        self.assertEqual(band.DataType, gdal.GDT_Float64)
        self.assertTrue((band.ReadAsArray() == values * 0.1).all())

    def test_lines_and_windows_have_the_pixels_of_the_whole(self):
        whole = heights(terrain("coast"))
        band = opened(terrain("coast")).GetRasterBand(1)
        lines = numpy.vstack([band.ReadAsArray(0, i, 257, 1) for i in range(257)])
        self.assertTrue((lines == whole).all())
        self.assertTrue((band.ReadAsArray(100, 50, 31, 77) == whole[50:127, 100:131]).all())
        as_whole_numbers = band.ReadAsArray(0, 0, 257, 257, buf_type=gdal.GDT_Int16)
        self.assertTrue((as_whole_numbers == whole).all())

    def test_overviews_are_levels_that_fit_together(self):
        data = opened(terrain("mountains"))
        band = data.GetRasterBand(1)
        self.assertEqual([(band.GetOverview(i).XSize, band.GetOverview(i).YSize) for i in range(band.GetOverviewCount())], [(129, 129)])
        self.assertIsNone(band.GetOverview(1))
        small = band.GetOverview(0).ReadAsArray()
        self.assertTrue((small == band.ReadAsArray(buf_xsize=129, buf_ysize=129)).all())
        # A window in the same pixels is asked with the same TIN.
        quarter = band.ReadAsArray(0, 0, 128, 128, buf_xsize=64, buf_ysize=64)
        whole = band.ReadAsArray(0, 0, 256, 256, buf_xsize=128, buf_ysize=128)
        self.assertTrue((whole[:64, :64] == quarter).all())
        # Neither a sample nor a mean: but near.
        exact = heights(terrain("mountains"), "ERROR=0", buf_xsize=129, buf_ysize=129)
        self.assertLess(numpy.sqrt(((small - exact) ** 2).mean()), 5)
        self.assertTrue((small != exact).any())

    def test_errors_are_kept(self):
        exact = heights(terrain("mountains"))
        for error in 1, 20:
            far = abs(heights(terrain("mountains"), f"ERROR={error}") - exact).max()
            self.assertTrue(error / 4 < far <= error, far)

    def test_windows_between_pixels_are_honoured(self):
        # A window of 2 x 2 pixels that begins in the middle of one, in 2 x 2: between four centres each.
        xml = f"""<VRTDataset rasterXSize="2" rasterYSize="2"><VRTRasterBand dataType="Float32" band="1"><SimpleSource>
            <SourceFilename>{terrain("mountains")}</SourceFilename><SrcRect xOff="10.5" yOff="20.5" xSize="2" ySize="2"/>
            <DstRect xOff="0" yOff="0" xSize="2" ySize="2"/></SimpleSource></VRTRasterBand></VRTDataset>"""
        whole = heights(terrain("mountains"))
        shifted = gdal.Open(xml).ReadAsArray()
        for j in range(2):
            for i in range(2):
                corners = whole[20 + j:22 + j, 10 + i:12 + i]
                middle = [(corners[0, 0] + corners[1, 1]) / 2, (corners[0, 1] + corners[1, 0]) / 2]
                self.assertIn(shifted[j, i], middle)

    def test_no_frame_without_heights(self):
        near = heights(terrain("mountains"), xoff=0, yoff=0, xsize=2, ysize=2, buf_xsize=64, buf_ysize=64)
        self.assertTrue((near > 600).all())
        run("gdalwarp", "-q", "-overwrite", "-tr", "7", "7", terrain("mountains"), "frame.tif")
        self.assertGreater(gdal.Open(scratch("frame.tif")).ReadAsArray().min(), 600)

    def test_slope_aspect_and_hillshade_are_those_of_export(self):
        for what in "slope", "aspect", "hillshade":
            run(PROGRAM, "export", terrain("mountains"), "--what", what, "-o", what + ".tif", "--overwrite", "-q")
            a, b = opened(scratch(what + ".tif")).GetRasterBand(1), opened(terrain("mountains"), "BAND=" + what).GetRasterBand(1)
            self.assertEqual((a.DataType, a.GetNoDataValue(), a.GetUnitType()), (b.DataType, b.GetNoDataValue(), b.GetUnitType()))
            self.assertTrue((a.ReadAsArray() == b.ReadAsArray()).all())
            self.assertIsNone(b.GetMinimum())

    def test_points_have_pixels_as_dense_as_they_are(self):
        data = opened(terrain("points"))
        self.assertEqual((data.RasterXSize, data.RasterYSize), (120, 120))
        self.assertEqual(data.GetGeoTransform()[1], 2)
        x, y = data.GetGeoTransform()[0] + 31, data.GetGeoTransform()[3] - 51
        told = run(PROGRAM, "locate", terrain("points"), str(x), str(y), "--json")
        self.assertIn(f'"z":{data.ReadAsArray()[25, 15]:.6f}'[:-3], told.replace(" ", "").replace('"height"', '"z"'))
        self.assertEqual(opened(terrain("points"), "PIXEL_SIZE=0.5").RasterXSize, 480)

    def test_pixels_of_other_types_are_those_of_the_band(self):
        # Lines come from GDAL's blocks, which are Float32, and the whole does not.
        for what in "height", "slope":
            band = opened(terrain("mountains"), "BAND=" + what, "ERROR=5").GetRasterBand(1)
            lines = numpy.vstack([band.ReadAsArray(0, i, 257, 1, buf_type=gdal.GDT_Float64) for i in range(257)])
            whole = band.ReadAsArray(buf_type=gdal.GDT_Float64)
            self.assertTrue((whole == lines).all())
            self.assertTrue((whole == band.ReadAsArray()).all())

    def test_lines_of_whole_pixels_are_read_by_blocks(self):
        # VRT and rasterio give windows as real numbers, whole ones too; line by line without blocks reads 38 times as many bytes as the file has.
        def bytes_read():
            with open("/proc/self/io", encoding="ascii") as file:
                return int(file.readline().split()[1])

        gdal.BuildVRT(scratch("lines.vrt"), [terrain("mountains")])
        for name in terrain("mountains"), scratch("lines.vrt"):
            band = opened(name).GetRasterBand(1)
            before = bytes_read()
            for i in range(257):
                band.ReadAsArray(0, i, 257, 1)
            self.assertLess(bytes_read() - before, 8 * os.path.getsize(terrain("mountains")))

    def test_columns_go_east_and_rows_south_whichever_way_the_source_goes(self):
        data = opened(source("mountains"))
        values, place = data.ReadAsArray(), data.GetGeoTransform()
        for east, north in (1, 1), (-1, -1), (-1, 1):
            corner = place[0] if east > 0 else place[0] + 257 * 30, place[3] - 257 * 30 if north > 0 else place[3]
            write("turned", values[::-north, ::east], [corner[0], 30 * east, 0, corner[1], 0, 30 * north], data.GetProjection())
            ours = opened(build("turned"), "INTERVAL=100")
            self.assertEqual(ours.GetGeoTransform(), place)
            self.assertTrue((ours.ReadAsArray() == values).all())
            finer = opened(scratch("turned.ptin"), "PIXEL_SIZE=10")
            self.assertEqual((finer.RasterXSize, finer.RasterYSize), (769, 769))
            self.assertTrue((finer.ReadAsArray()[::3, ::3] == values).all())
            feature = ours.GetLayer(1).GetNextFeature()  # which owns its geometry
            line = feature.GetGeometryRef()
            column, row = (line.GetX(0) - place[0]) // 30, (place[3] - line.GetY(0)) // 30
            near = values[max(int(row) - 1, 0):int(row) + 2, max(int(column) - 1, 0):int(column) + 2]
            self.assertTrue(near.min() <= line.GetZ(0) <= near.max())
            slope = opened(scratch("turned.ptin"), "BAND=slope").ReadAsArray()
            self.assertTrue((slope == heights(terrain("mountains"), "BAND=slope")).all())

    def test_degrees_are_longitudes_first_and_slopes_over_ground(self):
        # A plane that rises by 1 m a second of arc to the east, at 60 degrees north.
        second = 1 / 3600
        values = numpy.tile(numpy.arange(50, dtype=float), (40, 1))
        place = [10.0, second, 0, 60.0, 0, -second]
        crs = osr.SpatialReference()
        crs.ImportFromEPSG(4326)
        write("degrees", values, place, crs.ExportToWkt())
        data = opened(build("degrees"), "INTERVAL=7")
        numpy.testing.assert_allclose(data.GetGeoTransform(), place, rtol=0, atol=1e-12)
        self.assertTrue((data.ReadAsArray() == values).all())
        self.assertEqual(data.GetSpatialRef().GetAuthorityCode(None), "4326")
        for srs in data.GetSpatialRef(), data.GetLayer(0).GetSpatialRef(), data.GetLayer(1).GetSpatialRef():
            self.assertEqual(srs.GetDataAxisToSRSAxisMapping(), [2, 1])
        feature = data.GetLayer(1).GetNextFeature()
        line = feature.GetGeometryRef()
        self.assertAlmostEqual(line.GetX(0), 10 + 7.5 * second, delta=1e-9)
        self.assertTrue(60 - 40 * second <= line.GetY(0) <= 60)
        slope = heights(scratch("degrees.ptin"), "BAND=slope")
        self.assertTrue((abs(slope - numpy.degrees(numpy.arctan(1 / 15.5))) < 0.01).all())
        self.assertTrue((heights(scratch("degrees.ptin"), "BAND=aspect") == 270).all())
        finer = opened(scratch("degrees.ptin"), f"PIXEL_SIZE={second / 2}")
        self.assertEqual((finer.RasterXSize, finer.RasterYSize), (99, 79))
        run("gdalwarp", "-q", "-overwrite", "-t_srs", "EPSG:32632", "degrees.ptin", "warped.tif")
        columns, rows, low, high = statistics(scratch("warped.tif"))
        self.assertTrue(columns < rows and low == 0 and high == 49, (columns, rows, low, high))


class Certificates(Case):
    @staticmethod
    def of(what):
        told = what.GetMetadata("PTIN")
        return float(told["CERTIFIED_ERROR"]), float(told["CERTIFIED_DEVIATION"])

    def test_a_band_tells_what_its_pixels_are_certified_for(self):
        exact = heights(terrain("mountains"))
        band = opened(terrain("mountains")).GetRasterBand(1)
        self.assertEqual(self.of(band)[0], 0)
        self.assertEqual(self.of(band)[1], 2 ** -14)  # half of the last place of 1576 as Float32
        band = opened(terrain("mountains"), "PIXEL_SIZE=10").GetRasterBand(1)  # overviews finer and coarser than the source
        told = [self.of(band.GetOverview(i)) for i in range(band.GetOverviewCount())]
        self.assertEqual(told[0][0], 0)
        self.assertTrue(0 < told[1][0] < told[1][1], told)
        for i, (error, _) in enumerate(told):
            small = band.GetOverview(i)
            same = opened(terrain("mountains"), "PIXEL_SIZE=10", f"ERROR={error}").GetRasterBand(1)
            self.assertTrue((same.GetOverview(i).ReadAsArray() == small.ReadAsArray()).all())
            self.assertLessEqual(abs(heights(terrain("mountains"), f"ERROR={error}") - exact).max(), error)
        self.assertIn("CERTIFIED_ERROR=0\n", run("gdalinfo", "-mdd", "PTIN", terrain("mountains")))

    def test_an_error_that_was_asked_for_is_told(self):
        for error in 1, 20:
            bound, deviation = self.of(opened(terrain("mountains"), f"ERROR={error}").GetRasterBand(1))
            far = abs(heights(terrain("mountains"), f"ERROR={error}") - heights(terrain("mountains"))).max()
            self.assertTrue(far <= bound <= error + 1e-4 < deviation, (far, bound, deviation))
        self.assertEqual(opened(terrain("mountains"), "BAND=slope").GetRasterBand(1).GetMetadata("PTIN"), {})

    def test_layers_tell_it(self):
        layer = opened(terrain("mountains")).GetLayer(0)
        whole = self.of(layer)
        self.assertTrue(0 < whole[0] < whole[1], whole)
        self.assertEqual(layer.GetFeatureCount(), opened(terrain("mountains"), f"ERROR={whole[0]}").GetLayer(0).GetFeatureCount())
        layer.SetSpatialFilterRect(378000, 3802000, 380000, 3804000)
        self.assertEqual(self.of(layer), whole)
        self.assertEqual(float(layer.GetMetadataItem("CERTIFIED_ERROR", "PTIN")), whole[0])
        lines = opened(terrain("mountains"), "INTERVAL=100").GetLayer(1)
        self.assertEqual(self.of(lines), (0, 0))
        data = opened(terrain("mountains"), "INTERVAL=100", "ERROR=5")
        self.assertTrue(4 < self.of(data.GetLayer(1))[0] <= 5)
        self.assertEqual(self.of(data.GetLayer(0)), self.of(data.GetLayer(1)))

    def test_what_programs_make_of_a_terrain_tells_none(self):
        run("gdal_translate", "-q", "-outsize", "9", "9", terrain("mountains"), "nine.tif")
        run("gdalwarp", "-q", "-overwrite", "-tr", "900", "900", terrain("mountains"), "warped.tif")
        run("ogr2ogr", "-overwrite", "-simplify", "90", "-oo", "ERROR=5", "nine.gpkg", terrain("mountains"), "triangles")
        for name in "nine.tif", "warped.tif", "nine.gpkg":
            told = run("ogrinfo" if name.endswith("gpkg") else "gdalinfo", *(["-so", "-al"] if name.endswith("gpkg") else []), "-mdd", "all", name)
            self.assertNotIn("CERTIFIED", told)


class Voids(Case):
    """A terrain with so many voids that few pixels are fewer than the vertices that keep their borders."""

    def setUp(self):
        if not os.path.exists(scratch("holes.ptin")):
            mountains = heights(source("mountains"))
            mountains[numpy.random.default_rng(1).random(mountains.shape) < 0.03] = -9999
            whole = gdal.Open(source("mountains"))
            write("holes", mountains, whole.GetGeoTransform(), whole.GetProjection())
            run("gdal_translate", "-q", "-a_nodata", "-9999", "holes.tif", "holes.vrt")
            run(PROGRAM, "build", "holes.vrt", "-o", "holes.ptin", "-q")

    def test_few_pixels_have_heights(self):
        data = opened(terrain("holes"))
        band = data.GetRasterBand(1)
        for side, share in (5, 0.5), (20, 0.8), (84, 0.9):
            pixels = band.ReadAsArray(buf_xsize=side, buf_ysize=side)
            self.assertGreater((pixels != -9999).mean(), share)
        statistics = band.ComputeStatistics(True)
        self.assertTrue(statistics[0] < statistics[2] < statistics[1])
        told = [float(band.GetOverview(i).GetMetadata("PTIN")["CERTIFIED_ERROR"]) for i in range(band.GetOverviewCount())]
        self.assertTrue(all(error < 1000 for error in told), told)


class Statistics(Case):
    def test_range_is_that_of_the_header(self):
        band = opened(terrain("mountains")).GetRasterBand(1)
        self.assertEqual((band.GetMinimum(), band.GetMaximum()), (633, 1576))
        self.assertEqual(band.ComputeRasterMinMax(True), (633, 1576))
        low, high, mean, spread = band.ComputeStatistics(True)
        self.assertEqual((low, high), (633, 1576))
        self.assertEqual(band.GetStatistics(True, False)[:2], [low, high])
        exact = heights(terrain("mountains"))
        self.assertLess(abs(mean - exact.mean()), 2)
        self.assertLess(abs(spread - exact.std()), 2)

    def test_spacings_of_zero_mean_packed(self):
        band = opened(terrain("coast")).GetRasterBand(1)
        whole = heights(terrain("coast"))
        counts = band.GetHistogram(-0.5, 767.5, 768, approx_ok=True)
        share = numpy.count_nonzero(whole != band.GetNoDataValue()) / whole.size
        self.assertTrue(0.9 < sum(counts) / share / 50 ** 2 < 1.2, sum(counts))
        # GDAL asks for a small picture of the whole, in one call.
        data = opened(terrain("mountains"), "PIXEL_SIZE=3")
        low, high, mean, _ = data.GetRasterBand(1).ComputeStatistics(True)
        self.assertLess(abs(mean - heights(terrain("mountains")).mean()), 1.5)

        # The same of a raster that is smaller than a block.
        corner = opened(terrain("mountains"), "PIXEL_SIZE=300").GetRasterBand(1)
        self.assertEqual(sum(corner.GetHistogram(600, 1600, 100, approx_ok=True)), 26 * 26)
        self.assertLess(abs(corner.ComputeStatistics(True)[2] - corner.ReadAsArray().mean(dtype=float)), 1e-6)

    def test_nothing_is_written_beside_a_terrain(self):
        folder = scratch("alone")
        shutil.rmtree(folder, ignore_errors=True)
        os.mkdir(folder)
        path = shutil.copy(terrain("mountains"), folder)
        run("gdalinfo", "-stats", "-hist", "-mm", path)
        data = opened(path)
        data.GetRasterBand(1).SetMetadataItem("a", "b")
        data.GetRasterBand(1).GetDefaultHistogram()
        del data
        KEPT.clear()
        self.assertEqual(os.listdir(folder), ["mountains.ptin"])


class Layers(Case):
    @staticmethod
    def features(path, layer, *options, box=None):
        data = opened(path, *options)
        features = data.GetLayerByName(layer)
        if box:
            features.SetSpatialFilterRect(*box)
        return {f.GetFID(): f.GetGeometryRef().Clone() for f in features}

    def test_what_is_refused_is_not_counted(self):
        layer = opened(terrain("mountains"), "ERROR=0", "MEMORY_MB=1").GetLayer(0)
        count = []
        self.assertIn("MEMORY_MB", failure(lambda: count.append(layer.GetFeatureCount()))[1])
        self.assertEqual(count, [-1])
        layer.SetSpatialFilterRect(378000, 3802000, 378100, 3802100)
        self.assertGreater(layer.GetFeatureCount(), 0)

    def test_triangles_cover_the_terrain(self):
        triangles = self.features(terrain("mountains"), "triangles", "ERROR=10")
        self.assertAlmostEqual(sum(t.Area() for t in triangles.values()), (256 * 30) ** 2, delta=1)
        self.assertEqual({t.GetGeometryType() for t in triangles.values()}, {ogr.wkbPolygon25D})
        some = self.features(terrain("mountains"), "triangles", "ERROR=10", box=(378000, 3802000, 379000, 3803000))
        self.assertTrue(10 < len(some) < len(triangles) / 10)
        for number, triangle in some.items():  # the numbers do not depend on the filter
            self.assertTrue(triangle.Equals(triangles[number]))
        self.assertFalse(self.features(terrain("mountains"), "triangles", box=(0, 0, 1, 1)))
        self.assertLess(len(self.features(terrain("coast"), "triangles")), 2 * 50000)

    def test_isolines_are_those_of_the_program(self):
        lines = self.features(terrain("coast"), "isolines", "INTERVAL=50")
        run(PROGRAM, "isoline", terrain("coast"), "--interval", "50", "-o", "lines.gpkg", "--overwrite", "-q")
        data = opened(scratch("lines.gpkg"))
        known = [f.GetGeometryRef().Clone() for f in data.GetLayer(0)]
        self.assertEqual(len(lines), len(known))
        self.assertAlmostEqual(sum(x.Length() for x in lines.values()), sum(x.Length() for x in known), delta=1e-9)
        layer = opened(terrain("coast"), "INTERVAL=50").GetLayer(1)
        self.assertTrue(all(f["elev"] == f.GetGeometryRef().GetZ(0) for f in layer))
        layer.SetAttributeFilter("elev = 100")
        self.assertEqual({f["elev"] for f in layer}, {100.0})
        self.assertEqual(opened(terrain("coast")).GetLayerCount(), 1)

    def test_a_feature_is_the_same_whatever_the_filter(self):
        small = ["INTERVAL=20", "ERROR=2", "MEMORY_MB=1"]  # of which lines have several cells
        for options, name in (["INTERVAL=20"], "isolines"), (small, "isolines"), ([], "triangles"):
            whole = self.features(terrain("mountains"), name, *options)
            layer = opened(terrain("mountains"), *options).GetLayerByName(name)
            self.assertTrue(layer.TestCapability(ogr.OLCRandomRead))
            for box in (378000, 3802000, 380000, 3804000), (379000, 3803000, 379100, 3803100), (383000, 3806000, 383500, 3807000):
                layer.SetSpatialFilterRect(*box)
                found = {f.GetFID(): f.GetGeometryRef().Clone() for f in layer}
                self.assertEqual(layer.GetFeatureCount(), len(found))
                square = ogr.CreateGeometryFromWkt("POLYGON(({0} {1},{2} {1},{2} {3},{0} {3},{0} {1}))".format(*box))
                self.assertEqual(set(found), {number for number, shape in whole.items() if shape.Intersects(square)})
                for number, shape in found.items():
                    self.assertTrue(shape.Equals(whole[number]))
                for number in list(whole)[:: max(1, len(whole) // 20)]:
                    feature = layer.GetFeature(number)
                    self.assertTrue(feature.GetFID() == number and feature.GetGeometryRef().Equals(whole[number]))

    def test_cells_of_isolines_are_the_lines_of_the_terrain(self):
        joined = self.features(terrain("mountains"), "isolines", "INTERVAL=20")
        cells = self.features(terrain("mountains"), "isolines", "INTERVAL=20", "MEMORY_MB=1")
        self.assertGreater(len({number >> 32 for number in cells}), 1)
        self.assertAlmostEqual(sum(x.Length() for x in cells.values()), sum(x.Length() for x in joined.values()), delta=1e-5)
        ends = {}  # where lines are cut two of them meet, to the bit
        for line in cells.values():
            for end in (line.GetPoint(0), line.GetPoint(line.GetPointCount() - 1)):
                ends[end] = ends.get(end, 0) + 1
        border = {end for line in joined.values() for end in (line.GetPoint(0), line.GetPoint(line.GetPointCount() - 1))}
        self.assertEqual({count for end, count in ends.items() if end not in border}, {2})

    def test_numbers_are_found_beside_reading(self):
        for options, name in (["INTERVAL=20"], "isolines"), ([], "triangles"):
            layer = opened(terrain("mountains"), *options).GetLayerByName(name)
            layer.SetSpatialFilterRect(378000, 3802000, 380000, 3804000)
            found = {f.GetFID(): f.GetGeometryRef().Clone() for f in layer}
            self.assertGreater(len(found), 10)
            layer.ResetReading()
            numbers = [layer.GetNextFeature().GetFID()]
            for number, geometry in found.items():
                feature = layer.GetFeature(number)
                self.assertEqual(feature.GetFID(), number)
                self.assertTrue(feature.GetGeometryRef().Equals(geometry))
            self.assertEqual(failure(lambda of=layer: of.GetFeature(1 << 62)), (None, ""))
            numbers += [f.GetFID() for f in iter(layer.GetNextFeature, None)]  # reading goes on where it was
            self.assertEqual(numbers, list(found))
            layer.SetSpatialFilterRect(0, 0, 1, 1)
            feature = layer.GetFeature(numbers[-1])
            self.assertTrue(feature.GetGeometryRef().Equals(found[numbers[-1]]))
        # A triangle is known by its place, too, and no others are read for it.
        some = self.features(terrain("mountains"), "triangles", "ERROR=10")
        layer = opened(terrain("mountains"), "ERROR=10").GetLayer(0)
        layer.SetSpatialFilterRect(378000, 3802000, 378100, 3802100)
        near = {f.GetFID() for f in layer}
        self.assertTrue(near)
        for number in list(some)[::20]:
            feature = layer.GetFeature(number)
            self.assertTrue(feature.GetGeometryRef().Equals(some[number]))
            self.assertEqual(feature.GetDefnRef().GetName(), "triangles")
            for other in number + 1, -number:
                self.assertEqual(failure(lambda n=other: layer.GetFeature(n)), (None, ""))
        self.assertEqual({f.GetFID() for f in layer}, near)
        exact = self.features(terrain("mountains"), "triangles", "ERROR=0", box=(378000, 3802000, 378100, 3802100))
        small = opened(terrain("mountains"), "MEMORY_MB=1", "ERROR=0").GetLayer(0)
        self.assertTrue(all(small.GetFeature(number) for number in exact))
        # Without a question before, it is the one of the filter.
        fresh = opened(terrain("mountains"), "INTERVAL=20").GetLayer(1)
        self.assertEqual(fresh.GetFeature(3).GetFID(), 3)

    def test_the_crs_outlives_the_dataset(self):
        data = opened(terrain("mountains"), "INTERVAL=100")
        layers = [data.GetLayer(i) for i in range(2)]
        known = [data.GetSpatialRef()] + [layer.GetSpatialRef() for layer in layers]
        features = [layer.GetNextFeature() for layer in layers]  # which own their geometries
        geometries = [feature.GetGeometryRef().Clone() for feature in features]
        del data, layers, features
        KEPT.clear()
        others = [opened(terrain("coast")).GetSpatialRef() for _ in range(20)]  # what took the memory
        self.assertTrue(others[0])
        for srs in known + [geometry.GetSpatialReference() for geometry in geometries]:
            self.assertEqual(srs.GetAuthorityCode(None), "32611")
        for geometry in geometries:
            self.assertEqual(geometry.TransformTo(known[0].CloneGeogCS()), 0)

    def test_ogrinfo_shows_both(self):
        told = run("ogrinfo", "-so", "-al", terrain("mountains"), "-oo", "INTERVAL=100", "-oo", "ERROR=5", "-spat", "378000", "3802000", "380000",
                   "3804000")
        self.assertRegex(told, r"triangles\nGeometry: 3D Polygon\nFeature Count: [1-9][0-9]{2,}")
        self.assertRegex(told, r"isolines\nGeometry: 3D Line String\nFeature Count: [1-9]")


class Refusals(Case):
    def test_writing_is_refused_without_a_word(self):
        for flags in gdal.OF_RASTER, gdal.OF_VECTOR, gdal.OF_RASTER | gdal.OF_VECTOR:
            self.assertEqual(failure(lambda f=flags: gdal.OpenEx(terrain("coast"), f | gdal.OF_UPDATE)), (None, ""))
        self.assertIn("PTIN", run("ogrinfo", terrain("coast")))  # which tries it first

    def test_options_that_mean_nothing_are_refused(self):
        for option in "ERROR=-1", "ERROR=x", "PIXEL_SIZE=0", "PIXEL_SIZE=100000", "PIXEL_SIZE=1e-9", "INTERVAL=0", "MEMORY_MB=0", "BAND=x":
            data, message = failure(lambda o=option: opened(terrain("mountains"), o))
            self.assertIsNone(data)
            self.assertRegex(message, "^ptin: " + option.split("=")[0] + ": [^\n]*$")

    def test_the_program_builds_from_no_terrain(self):
        told = run(PROGRAM, "build", terrain("coast"), "-o", "again.ptin", status=2)
        self.assertIn("this is a store, not a source", told)
        gdal.BuildVRT(scratch("around.vrt"), [terrain("coast")])
        self.assertIn("not recognized", run(PROGRAM, "build", "around.vrt", "-o", "again.ptin", status=6))
        self.assertFalse(os.path.exists(scratch("again.ptin")))

    def test_cut_and_flipped_files_are_one_error(self):
        with open(terrain("mountains"), "rb") as file:
            whole = file.read()
        exact = heights(terrain("mountains"))
        bad = scratch("bad.ptin")

        def read():
            data = opened(bad)
            if data is None:
                return None
            layer = data.GetLayer(0)
            return data.ReadAsArray(), layer.GetFeatureCount()

        def written(content):
            with open(bad, "wb") as file:
                file.write(content)
            return failure(read)

        for size in 8, 100, 4096, 5000, len(whole) // 2, len(whole) - 1:
            answer, message = written(whole[:size])
            self.assertIsNone(answer)
            self.assertRegex(message, "^ptin: [^\n]*bad.ptin[^\n]*$")
        for i in range(24):
            place = (len(whole) - 1) * i // 23
            answer, message = written(whole[:place] + bytes([whole[place] ^ 4]) + whole[place + 1:])
            if place < 8:  # GDAL leaves it to its caller to say that nothing reads it
                self.assertEqual((answer, message), (None, ""))
            elif message:
                self.assertRegex(message, "^ptin: [^\n]*bad.ptin[^\n]*$")
                self.assertTrue(answer is None or answer[0] is None or answer[1] == -1)
            else:  # what nobody asked for
                self.assertTrue((answer[0] == exact).all())

    def test_a_file_that_is_cut_while_it_is_open_is_an_error(self):
        path = shutil.copy(terrain("mountains"), scratch("open.ptin"))
        data = opened(path)
        os.truncate(path, 20000)
        array, message = failure(data.ReadAsArray)
        self.assertIsNone(array)
        self.assertRegex(message, "^ptin: ")

    def test_a_file_that_is_replaced_goes_on_answering(self):
        path = shutil.copy(terrain("mountains"), scratch("replaced.ptin"))
        data = opened(path)
        os.rename(shutil.copy(terrain("coast"), scratch("other.ptin")), path)
        self.assertTrue((data.ReadAsArray() == heights(terrain("mountains"))).all())

    def test_what_does_not_fit_the_memory_is_refused(self):
        self.assertIsNone(failure(lambda: heights(terrain("mountains"), "MEMORY_MB=1", buf_xsize=3000, buf_ysize=3000))[0])
        layer = opened(terrain("mountains"), "MEMORY_MB=1", "ERROR=0").GetLayer(0)
        feature, message = failure(layer.GetNextFeature)
        self.assertIsNone(feature)
        self.assertIn("MEMORY_MB", message)

    def test_a_progress_that_says_stop_stops(self):
        asked = []

        def stop(share, *_):
            asked.append(share)
            return 0

        band = opened(terrain("mountains")).GetRasterBand(1)
        array, message = failure(lambda: band.ReadAsArray(buf_xsize=200, buf_ysize=200, callback=stop))
        self.assertIsNone(array)
        self.assertTrue(asked)
        self.assertEqual(gdal.GetLastErrorNo(), gdal.CPLE_UserInterrupt)


class Programs(Case):
    def test_gdal_translate_takes_a_small_picture(self):
        run("gdal_translate", "-q", "-outsize", "100", "90", terrain("mountains"), "small.tif")
        columns, rows, low, high = statistics(scratch("small.tif"))
        self.assertEqual((columns, rows), (100, 90))
        self.assertTrue(633 <= low < 700 and 1500 < high <= 1576)

    def test_gdalwarp_gives_the_same_with_two_threads(self):
        for name, threads in ("one.tif", []), ("two.tif", ["-multi", "-wo", "NUM_THREADS=2"]):
            run("gdalwarp", "-q", "-overwrite", *threads, "-t_srs", "EPSG:4326", "-ts", "60", "0", terrain("mountains"), name)
        with open(scratch("one.tif"), "rb") as one, open(scratch("two.tif"), "rb") as two:
            self.assertEqual(one.read(), two.read())
        columns, _, low, high = statistics(scratch("one.tif"))
        self.assertTrue(columns == 60 and 633 <= low < 720 and 1480 < high <= 1576, (columns, low, high))

    def test_gdaldem_and_gdal_contour_give_what_they_give_for_the_source(self):
        for given, name in (terrain("mountains"), "ours"), (source("mountains"), "theirs"):
            run("gdaldem", "hillshade", "-q", given, name + ".tif")
            run("gdal_contour", "-q", "-i", "100", "-a", "elev", given, name + ".geojson")
        for end in ".tif", ".geojson":
            with open(scratch("ours" + end), "rb") as ours, open(scratch("theirs" + end), "rb") as theirs:
                self.assertEqual(ours.read().replace(b"ours", b""), theirs.read().replace(b"theirs", b""), end)

    def test_gdallocationinfo_finds_a_sample(self):
        told = run("gdallocationinfo", "-valonly", terrain("mountains"), "130", "40")
        self.assertEqual(float(told), heights(terrain("mountains"))[40, 130])

    def test_files_elsewhere_are_read(self):
        server = subprocess.Popen([sys.executable, RANGE_SERVER, os.path.dirname(terrain("coast"))], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        try:
            at = f"http://127.0.0.1:{int(server.stdout.readline())}"
            shutil.copy(terrain("coast"), scratch("SIGNED.PTIN"))
            for name in at + "/plain/coast.ptin", "/vsicurl/" + at + "/plain/coast.ptin", at + "/plain/SIGNED.PTIN?key=a/b.c#top":
                data = gdal.OpenEx(name, allowed_drivers=["PTIN"])  # and not by GDAL's own, which copies the whole file
                self.assertTrue((data.ReadAsArray() == heights(terrain("coast"))).all())
            data, message = failure(lambda: opened(at + "/missing/coast.ptin"))
            self.assertIsNone(data)
            self.assertIn("404", message)
        finally:
            server.communicate()
        with open(terrain("coast"), "rb") as file:
            gdal.FileFromMemBuffer("/vsimem/coast.ptin", file.read())
        self.assertTrue((heights("/vsimem/coast.ptin") == heights(terrain("coast"))).all())

    def test_rasterio_reads_windows(self):
        try:
            import rasterio
        except ImportError:
            self.skipTest("rasterio is not installed")
        with rasterio.open(terrain("mountains")) as data:
            self.assertTrue((data.read(1, window=((10, 40), (20, 60))) == heights(terrain("mountains"))[10:40, 20:60]).all())
            self.assertEqual(data.read(1, out_shape=(50, 50)).shape, (50, 50))
            self.assertEqual(data.crs.to_epsg(), 32611)
            self.assertEqual(next(data.sample([data.xy(7, 9)]))[0], heights(terrain("mountains"))[7, 9])

    def test_mapserver_draws_both(self):
        if shutil.which("map2img") is None:
            self.skipTest("MapServer is not installed")
        with open(scratch("both.map"), "w", encoding="utf-8") as file:
            file.write(f"""MAP
              EXTENT 376314 3800208 384023 3807917  SIZE 100 100  IMAGETYPE png
              LAYER TYPE RASTER STATUS DEFAULT DATA "{terrain("mountains")}" PROCESSING "SCALE=600,1600" END
              LAYER TYPE LINE STATUS DEFAULT CONNECTIONTYPE OGR CONNECTION "{terrain("mountains")}" DATA "triangles"
                CLASS STYLE COLOR 255 0 0 END END
              END
            END""")
        run("map2img", "-m", "both.map", "-o", "both.png")
        colours = gdal.Open(scratch("both.png")).ReadAsArray()
        self.assertEqual(colours.shape[-2:], (100, 100))
        self.assertGreater(colours[0].max(), colours[1].min())


if __name__ == "__main__":
    shutil.rmtree(SCRATCH, ignore_errors=True)
    os.makedirs(SCRATCH)
    unittest.main(argv=sys.argv[:1] + sys.argv[5:])
