#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Python module costs over the engine: one call, and a million points, on one terrain, in turn.

usage: bench/python.py LOCATE_BENCH MODULES FILE
LOCATE_BENCH is locate_bench of a build, MODULES its folder python. Medians of five rounds; points are uniform and seeded. A call
whose point lies outside has next to nothing to do but to be called. The module reads the file, where C++ maps it.
"""
import json
import os
import statistics
import subprocess
import sys
import time

from support.markdown import print_head, print_row

ROUNDS = 5


def engine_times(program, file):
    """Microseconds of one point, and of a million."""
    command = [program, "--benchmark_filter=LocateOne$|LocateBatch/1000000", "--benchmark_format=json"]
    done = subprocess.run(command, env={**os.environ, "PTIN_BENCH_STORE": file}, check=True, capture_output=True)
    scale = {"us": 1, "ms": 1000}
    one, batch = (b["real_time"] * scale[b["time_unit"]] for b in json.loads(done.stdout)["benchmarks"])
    return one, batch


def module_times(terrain, points):
    """The same through the module."""
    few = [tuple(map(float, p)) for p in points[:1000]]
    began = time.perf_counter()
    for p in few * 20:
        terrain.locate(p)
    one = time.perf_counter()
    for p in [(1e300, 1e300)] * 20_000:
        terrain.locate(p)
    outside = time.perf_counter()
    terrain.locate(points)
    return (one - began) / 20_000 * 1e6, (outside - one) / 20_000 * 1e6, (time.perf_counter() - outside) * 1e6


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program, modules, file = map(os.path.abspath, sys.argv[1:])
    sys.path.insert(0, modules)
    import numpy as np
    import ptin

    terrain = ptin.open(file)
    xmin, ymin, xmax, ymax = terrain.bounds
    points = np.random.default_rng(1).uniform((xmin, ymin), (xmax, ymax), (1_000_000, 2))
    terrain.locate(points)  # so that pages are in memory
    rounds = [(*engine_times(program, file), *module_times(terrain, points)) for _ in range(ROUNDS)]
    one, batch, one_here, outside, batch_here = (statistics.median(times) for times in zip(*rounds))
    print_head("", "C++", "Python", "difference")
    print_row("one point outside, us", "", f"{outside:.2f}", "")
    print_row("one point, us", f"{one:.2f}", f"{one_here:.2f}", f"{one_here - one:.2f}")
    print_row("a million points, ms", f"{batch / 1000:.0f}", f"{batch_here / 1000:.0f}", f"{(batch_here / batch - 1) * 100:.1f} %")


if __name__ == "__main__":
    main()
