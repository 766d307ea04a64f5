# SPDX-License-Identifier: GPL-3.0-or-later
"""pip's way to the module: CMake builds it, as everywhere. CMAKE_ARGS of the environment goes to CMake."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parents[2]


def folders_of_pybind11():
    """Where pip has put pybind11; none where CMake finds the one of the system."""
    try:
        import pybind11
    except ImportError:
        return []
    return [pybind11.get_cmake_dir()]


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        built = Path(self.build_temp).resolve()
        arguments = ["-D", "PTIN_PYTHON=ON", "-D", "CMAKE_BUILD_TYPE=Release", "-D", f"Python_EXECUTABLE={sys.executable}"]
        arguments += ["-D", f"PTIN_MODULE_FOLDER={Path(self.get_ext_fullpath(extension.name)).resolve().parent}"]
        arguments += [f"-Dpybind11_DIR={folder}" for folder in folders_of_pybind11()]
        arguments += shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run(["cmake", "-G", "Ninja", "-S", str(ROOT), "-B", str(built), *arguments], check=True)
        subprocess.run(["cmake", "--build", str(built), "--target", "ptin_python"], check=True)


version = re.search(r"VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text().split("project(", 1)[1])
setup(
    version=version[1],
    ext_modules=[Extension("ptin._ptin", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
)
