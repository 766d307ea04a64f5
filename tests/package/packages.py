#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Debian packages of a build: what is in them, what they depend on, and that they work where they are unpacked.

usage: packages.py BUILD ROOT SCRATCH [unittest's arguments]
BUILD is the folder of a release build with plugin and module, ROOT the tree. Exit status 77, with a sentence, where what makes
packages is not installed. That they can be installed is for tests/package/chroot, which downloads a system to install them on."""

import glob
import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
import unittest
from pathlib import Path

if len(sys.argv) < 4:
    sys.exit(__doc__)
BUILD, ROOT, SCRATCH = (Path(path).resolve() for path in sys.argv[1:4])
for tool in ("dh", "dh_python3", "lintian", "readelf"):
    if not shutil.which(tool):
        print(f"skipped: {tool} is not installed")
        sys.exit(77)
for part in ("bin/ptin", "gdalplugins/gdal_PTIN.so", "python/ptin/_ptin.*.so"):
    if not glob.glob(str(BUILD / part)):
        print(f"skipped: {part} is not built")
        sys.exit(77)

NAMES = ("libptin-dev", "ptin", "ptin-gdal", "python3-ptin")
PACKAGE = ROOT / "tools/package"
TERRAINS = SCRATCH / "terrains"


def run(*command, **options):
    """Standard output and error of a command."""
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          **options)
    if done.returncode != 0:
        raise AssertionError(f"{shlex.join(str(word) for word in command)}\nended with {done.returncode}\n{done.stdout}")
    return done.stdout


def deb(name, folder="first"):
    (found,) = (SCRATCH / folder).glob(f"{name}_*.deb")
    return found


def field(name, of):
    return run("dpkg-deb", "--field", deb(name), of).strip()


def depends(name):
    """The names of the packages that a package depends on."""
    return {part.split()[0] for part in field(name, "Depends").split(",")}


def needed(path):
    """The shared libraries that a program or library asks for."""
    return set(re.findall(r"\(NEEDED\).*\[(.*?)\.so", run("readelf", "--dynamic", path)))


def files(name):
    """What a package installs: paths from the root of the system."""
    return {str(path.relative_to(SCRATCH / name)) for path in (SCRATCH / name).rglob("*") if not path.is_dir()}


def unpacked(pattern):
    (found,) = (SCRATCH / "system").glob(pattern)
    return found


def text(path):
    return (ROOT / path).read_text(encoding="utf-8")


def setUpModule():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    # Bytes are compared, and packing small takes half the time.
    os.environ["DPKG_DEB_COMPRESSOR_LEVEL"] = "0"
    making = [subprocess.Popen([PACKAGE / "build", SCRATCH / folder, "--from", BUILD], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True) for folder in ("first", "second")]
    for process in making:
        said, _ = process.communicate()
        if process.returncode != 0:
            raise AssertionError(f"tools/package/build ended with {process.returncode}\n{said}")
    for name in NAMES:
        run("dpkg-deb", "--extract", deb(name), SCRATCH / name)
        run("dpkg-deb", "--extract", deb(name), SCRATCH / "system")
    # The first command of the README, by the program of the package.
    TERRAINS.mkdir()
    shutil.copy(ROOT / "tests/data/mountains_257.tif", TERRAINS / "dem.tif")
    commands = text("README.md").split("## Three commands")[1].split("```")[1]
    first = shlex.split(re.search(r"^\$ (ptin build .*)$", commands, re.M)[1], comments=True)
    run(unpacked("usr/bin/ptin"), *first[1:], cwd=TERRAINS)


class Packages(unittest.TestCase):
    maxDiff = None

    def test_of_the_same_input_have_the_same_bytes(self):
        self.assertEqual(sorted(path.name.split("_")[0] for path in (SCRATCH / "first").iterdir()), sorted(NAMES))
        for name in NAMES:
            self.assertEqual(deb(name).read_bytes(), deb(name, "second").read_bytes(), name)

    def test_please_lintian(self):
        said = run("lintian", "--allow-root", "--fail-on", "none", *(deb(name) for name in NAMES))
        self.assertEqual([line for line in said.splitlines() if re.match(r"[EW]: ", line)], [])

    def test_have_the_version_of_the_tree(self):
        version = re.search(r"VERSION ([0-9.]+)", text("CMakeLists.txt").split("project(")[1])[1]
        date = re.search(r"^## \[%s\] - ([0-9-]+)$" % version.rpartition(".")[0], text("CHANGELOG.md"), re.M)
        newest = run("dpkg-parsechangelog", "--file", PACKAGE / "debian/changelog", "--show-field", "Timestamp")
        self.assertIsNotNone(date, "CHANGELOG.md has no section of this version, with its date")
        self.assertEqual(date[1], time.strftime("%Y-%m-%d", time.gmtime(int(newest))))
        for name in NAMES:
            self.assertEqual(field(name, "Version"), version, name)
        self.assertIn(version, run(unpacked("usr/bin/ptin"), "--version"))
        self.assertIn(f'"{version}"', unpacked("usr/lib/*/cmake/ptin/ptinConfigVersion.cmake").read_text())

    def test_are_built_of_what_install_dependencies_installs(self):
        wanted = set(re.search(r"^Build-Depends: (.*(\n .*)*)", text("tools/package/debian/control"), re.M)[1]
                     .replace("\n", "").replace("debhelper-compat (= 13)", "debhelper")
                     .replace("dh-sequence-python3", "dh-python").replace(" ", "").split(","))
        sets = re.findall(r"^(?:program|packaging)=\((.*?)^\)", text("tools/install_dependencies"), re.M | re.S)
        listed = {word for line in "".join(sets).splitlines() if not line.strip().startswith("#") for word in line.split()}
        self.assertEqual(wanted, listed - {"g++"})

    def test_hold_what_people_look_for(self):
        version = field("ptin", "Version")
        self.assertLessEqual({"usr/bin/ptin", f"usr/libexec/ptin/{version}/ptin-whole", "usr/share/man/man1/ptin.1.gz",
                              "usr/share/bash-completion/completions/ptin", "usr/share/doc/ptin/copyright",
                              "usr/share/doc/ptin/examples/ptin.service"}, files("ptin"))
        self.assertIn("usr/include/ptin/engine/query/terrain.h", files("libptin-dev"))
        unpacked("usr/lib/*/libptin_query.a")
        folder = re.search(r"/(usr/lib/.*/gdalplugins)", "".join(run("dpkg", "--listfiles", "libgdal32")) + "/usr/lib/" +
                           run("dpkg-architecture", "-qDEB_HOST_MULTIARCH").strip() + "/gdalplugins")[1]
        self.assertIn(f"{folder}/gdal_PTIN.so", files("ptin-gdal"))
        self.assertIn("usr/lib/python3/dist-packages/ptin/__init__.py", files("python3-ptin"))
        run("bash", "-c", f"source {shlex.quote(str(unpacked('usr/share/bash-completion/completions/ptin')))}; complete -p ptin")


class Dependencies(unittest.TestCase):
    def test_are_those_of_what_is_used(self):
        self.assertLessEqual({"libgdal32", "libproj25", "libcurl4", "libcairo2", "libpng16-16", "libwebp7", "fonts-dejavu-core", "libc6"}, depends("ptin"))
        self.assertLessEqual({"libgdal32", "libc6"}, depends("ptin-gdal"))
        self.assertLessEqual({"libgdal32", "python3", "python3-numpy", "libc6"}, depends("python3-ptin"))

    def test_on_libspatialindex_are_of_what_asks_for_it(self):
        for name in NAMES:
            self.assertNotIn("spatialindex", field(name, "Depends") + field(name, "Recommends"), name)
        self.assertIn("libspatialindex", field("ptin", "Suggests"))
        for pattern in ("usr/bin/ptin", "usr/libexec/ptin/*/ptin-whole", "usr/lib/*/gdalplugins/gdal_PTIN.so", "usr/lib/python3/dist-packages/ptin/_ptin.*.so"):
            self.assertNotIn("libspatialindex", needed(unpacked(pattern)), pattern)
        self.assertIn("libspatialindex", needed(unpacked("usr/libexec/ptin/*/second_index.so")))


class Unpacked(unittest.TestCase):
    """The packages in a folder of their own: nothing of BUILD is used."""

    def test_program_answers_by_both_indexes(self):
        asked = ("locate", "dem.ptin", "378000", "3804000", "--json")
        answers = [run(unpacked("usr/bin/ptin"), *asked, *more, cwd=TERRAINS)
                   for more in ((), ("--by", "splits"), ("--index", "spatialindex"))]
        heights = [re.search(r'"height": *([-0-9.]+)', answer)[1] for answer in answers]
        self.assertEqual(heights, heights[:1] * 3)

    def test_library_is_found(self):
        run("cmake", "-S", ROOT / "tests/install/query", "-B", SCRATCH / "user", "-G", "Ninja", "-D", "CMAKE_CXX_FLAGS=-O0",
            "-D", f"CMAKE_PREFIX_PATH={SCRATCH}/libptin-dev/usr",
            *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("CGAL", "CURL", "EXPAT", "GDAL")))
        run("cmake", "--build", SCRATCH / "user")
        run(SCRATCH / "user/ptin_asker", TERRAINS / "dem.ptin")

    def test_plugin_is_read_by_gdal(self):
        if not shutil.which("gdalinfo"):
            self.skipTest("gdalinfo is not installed")
        plugins = unpacked("usr/lib/*/gdalplugins/gdal_PTIN.so").parent
        said = run("gdalinfo", TERRAINS / "dem.ptin", env={**os.environ, "GDAL_DRIVER_PATH": str(plugins)})
        self.assertIn("Driver: PTIN", said)
        self.assertIn("Size is 257, 257", said)

    def test_module_is_imported(self):
        asks = "import ptin; t = ptin.open('dem.ptin'); print(t.samples, ptin.__file__)"
        said = run("/usr/bin/python3", "-c", asks, cwd=TERRAINS,
                   env={**os.environ, "PYTHONPATH": str(unpacked("usr/lib/python3/dist-packages"))})
        self.assertEqual(said.split()[0], str(257 * 257))
        self.assertIn(str(SCRATCH), said)


class ContainerFile(unittest.TestCase):
    """No container is made here: what the file names is looked at, and its check of health is run."""

    def setUp(self):
        joined = re.sub(r"\\\n\s*", "", text("tools/package/Containerfile"))
        self.lines = [line for line in joined.splitlines() if line and not line.startswith("#")]

    def words(self, instruction):
        return [line.split(maxsplit=1)[1] for line in self.lines if line.split()[0] == instruction]

    def test_has_known_instructions_and_copies_what_is_there(self):
        self.assertLessEqual({line.split()[0] for line in self.lines}, {
            "FROM", "COPY", "RUN", "USER", "WORKDIR", "VOLUME", "EXPOSE", "HEALTHCHECK", "ENTRYPOINT", "CMD"})
        self.assertEqual(self.words("FROM"), ["debian:12-slim AS build", "debian:12-slim"])
        for copied in self.words("COPY"):
            for source in copied.split()[:-1]:
                self.assertTrue((ROOT / source).exists(), source)
        self.assertEqual(self.words("USER"), ["10001"])
        self.assertEqual(self.words("ENTRYPOINT"), ['["ptin"]'])
        runs = " ".join(self.words("RUN"))
        self.assertIn("/tmp/install_dependencies package", runs)
        for path in re.findall(r" /ptin/(\S+)", " " + runs):
            self.assertTrue(os.access(ROOT / path, os.X_OK), path)

    def test_copies_all_that_a_build_reads(self):
        copied = {source for line in self.words("COPY") for source in line.split()[:-1]}
        read = set(re.findall(r"^add_subdirectory\((\w+)", text("CMakeLists.txt"), re.M)) - {"tests", "bench"}
        self.assertLessEqual(read | {"CMakeLists.txt"}, copied)

    def test_check_of_health_tells_whether_the_service_answers(self):
        (check,) = self.words("HEALTHCHECK")
        command = eval(check.split(" CMD ", 1)[1])  # a list of strings, as JSON and Python write it
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        command = [word.replace("/8080", f"/{port}") for word in command]
        self.assertNotEqual(subprocess.run(command, capture_output=True, check=False).returncode, 0)
        service = subprocess.Popen([unpacked("usr/bin/ptin"), "serve", "dem=dem.ptin", "--listen", f"127.0.0.1:{port}"],
                                   cwd=TERRAINS, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        try:
            service.stdout.readline()  # it listens
            run(*command)
        finally:
            service.terminate()
            service.communicate()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
