#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `ptin serve` does: one row of a table a kind of question, and memory over many mixed ones.

usage: bench/serve.py PTIN SERVE_LOAD FILE [--threads N] [--requests N] [--seconds S] [--limit-memory SIZE] [--repeated]

Starts the service on FILE and asks seeded questions over loopback.
throughput   `wrk -t1 -c16` (Debian's package) over targets in turn, the service on the first core, wrk on the last
latency      SERVE_LOAD, an open loop at half of that rate: from the time at which a request was due
batches      one connection, one POST after the other; the best and the median time
memory       RSS less what is of the file itself (RssFile), every 2 s over --requests mixed questions. With --limit-memory
             (root) the service and its part of the page cache have no more than that, as a file larger than memory has
             it, and only this is measured
hang-up      long questions whose client leaves; until the service computes nothing, by /metrics
repeated     with --repeated alone: pages that the system gave the service (minor faults) for ten large questions that it has
             answered five times before, without a rest in between and after rests of three seconds
"""
import argparse
import json
import math
import os
import random
import re
import statistics
import subprocess
import sys
import tempfile
import time

from support.markdown import print_head, print_row
from support.service import Service

CORES = sorted(os.sched_getaffinity(0))


def limit_memory(service, size):
    """In a control group of its own, of version 1 or 2."""
    old = os.path.isdir("/sys/fs/cgroup/memory")
    group = ("/sys/fs/cgroup/memory" if old else "/sys/fs/cgroup") + "/ptin_bench_serve"
    os.makedirs(group, exist_ok=True)
    for name, value in [("memory.limit_in_bytes" if old else "memory.max", size), ("cgroup.procs", service.process.pid)]:
        with open(os.path.join(group, name), "w") as file:
            file.write(str(value))


def faults(service, field):
    """A number of /proc/PID/stat, counted from the state on: 7 are the minor faults, 9 the major ones."""
    with open(f"/proc/{service.process.pid}/stat") as file:
        return int(file.read().rsplit(") ", 1)[1].split()[field])


def major_faults(service):
    return faults(service, 9)


def repeated(service, bounds):
    """An exact mesh of the middle quarter, and isolines at 22 heights."""
    width, height = bounds["max_x"] - bounds["min_x"], bounds["max_y"] - bounds["min_y"]
    box = ",".join(str(edge) for edge in (bounds["min_x"] + width / 4, bounds["min_y"] + height / 4,
                                          bounds["max_x"] - width / 4, bounds["max_y"] - height / 4))
    terrain = json.loads(service.ask("/collections/dem")[1])["terrain"]
    low, high = terrain["heights"]
    for what, target in (("an exact mesh of a quarter", f"/collections/dem/mesh?f=ply&crs=native&bbox={box}"),
                         ("22 isolines", f"/collections/dem/isolines?interval={(high - low) / 22}")):
        for _ in range(5):
            status, answer = service.ask(target)
            if status != 200:
                sys.exit(f"{target}: {status}: {answer[:300]}")
        for rest in (0, 3):
            fresh, took = 0, []
            for _ in range(10):
                before, begun = faults(service, 7), time.perf_counter()
                service.ask(target)
                took.append(time.perf_counter() - begun)
                fresh += faults(service, 7) - before
                time.sleep(rest)
            print(f"{what}, ten times after rests of {rest} s: {fresh} page faults, median {1000 * statistics.median(took):.0f} ms")


class Places:
    """Seeded places of the file, in its own CRS."""

    def __init__(self, bounds, seed):
        self.bounds, self.random = bounds, random.Random(seed)

    def point(self):
        b, r = self.bounds, self.random
        return r.uniform(b["min_x"], b["max_x"]), r.uniform(b["min_y"], b["max_y"])

    def box(self, share):
        b = self.bounds
        w, h = (b["max_x"] - b["min_x"]) * share, (b["max_y"] - b["min_y"]) * share
        x = self.random.uniform(b["min_x"], b["max_x"] - w)
        y = self.random.uniform(b["min_y"], b["max_y"] - h)
        return f"{x},{y},{x + w},{y + h}"


def position(places):
    x, y = places.point()
    return f"/collections/dem/position?coords=POINT({x}%20{y})&crs=native&f=json"


def mixed(places):
    x, y = places.point()
    u, v = places.point()
    root, crs = "/collections/dem", "crs=native"
    return places.random.choice([
        position(places),
        f"{root}/position?coords=POINT({x}%20{y})&error=5&{crs}",
        f"{root}/profile?coords=LINESTRING({x}%20{y},{u}%20{v})&error=20&{crs}",
        f"{root}/sight?coords=LINESTRING({x}%20{y},{u}%20{v})&{crs}",
        f"{root}/mesh?bbox={places.box(0.02)}&error=5&{crs}",
        f"{root}/isolines?bbox={places.box(0.02)}&interval=50&{crs}",
        f"{root}/highest?bbox={places.box(0.1)}&{crs}",
        f"{root}/stream?window={places.box(0.05)}&error=10&max_bytes=65536",
    ])


def load(arguments, service, targets, rate, seconds, connections):
    with tempfile.NamedTemporaryFile("w") as file:
        file.write("\n".join(targets) + "\n")
        file.flush()
        out = subprocess.run(
            ["taskset", "-c", str(CORES[-1]), arguments.serve_load, service.address, str(rate), str(seconds),
             str(connections), file.name], capture_output=True, text=True)
    if out.returncode:
        sys.exit(out.stderr)
    return json.loads(out.stdout)


def throughput(service, targets, seconds):
    quoted = ",".join(json.dumps(t) for t in targets)
    with tempfile.NamedTemporaryFile("w", suffix=".lua") as file:
        file.write("local t={" + quoted + "}\nlocal i=0\n"
                   "request=function() i=i%#t+1 return wrk.format('GET',t[i]) end\n")
        file.flush()
        out = subprocess.run(["taskset", "-c", str(CORES[-1]), "wrk", "-t1", "-c16", f"-d{seconds}s", "-s", file.name,
                              f"http://{service.address}/"], capture_output=True, text=True, check=True).stdout
    if "Non-2xx" in out:
        sys.exit(out)
    return float(re.search(r"Requests/sec:\s+([0-9.]+)", out).group(1))


def open_loop(arguments, service, what, targets):
    rate = throughput(service, targets, arguments.seconds)
    ms = load(arguments, service, targets, rate / 2, arguments.seconds, 64)["ms"]
    print_row(what, f"{rate:.0f}/s", f"{ms['50']:.2f}", f"{ms['99']:.2f}", f"{ms['100']:.2f}")


def batch(service, what, target, body, count):
    times = []
    for _ in range(9):
        begin = time.perf_counter()
        status, answer = service.ask(target, body)
        times.append(time.perf_counter() - begin)
        if status != 200:
            sys.exit(answer.decode())
    best, median = min(times), statistics.median(times)
    print_row(what, f"{count / median:.0f}/s", f"{1e3 * best:.1f} (best)", f"{1e3 * median:.1f} (median)", "")


def batches(arguments, service, places, lon_lat):
    for what, area, crs in [("own CRS", places, "native"), ("CRS84", lon_lat, "CRS84")]:
        if area is None:
            continue
        points = ",".join("%.9g %.9g" % area.point() for _ in range(10000))
        for form in ["csv", "covjson"]:
            body = json.dumps({"coords": f"MULTIPOINT({points})", "crs": crs, "f": form})
            batch(service, f"10 000 random positions in a POST, {what}, {form}", "/collections/dem/position", body, 10000)
        (a, b), (c, d) = area.point(), area.point()
        route = ",".join("%.9g %.9g" % (a + (c - a) * i / 9999, b + (d - b) * i / 9999) for i in range(10000))
        body = json.dumps({"coords": f"MULTIPOINT({route})", "crs": crs, "f": "csv"})
        batch(service, f"10 000 positions along a way in a POST, {what}, csv", "/collections/dem/position", body, 10000)
    pairs = [[*places.point(), 2, *places.point(), 2] for _ in range(1000)]
    for verdict in [True, False]:
        body = json.dumps({"pairs": pairs, "crs": "native", "verdict": verdict})
        batch(service, "1 000 lines of sight in a POST" + (", verdicts" if verdict else ""), "/collections/dem/sight",
              body, 1000)


def meshes(arguments, service, places, how, count):
    """Windows of about 10 000 triangles: the 5 000 most important vertices of each."""
    root = "/collections/dem/mesh?crs=native&f=glb"
    open_loop(arguments, service, f"mesh of 10 000 triangles, GLB, {how}",
              [f"{root}&bbox={places.box(0.04)}&vertices=5000" for _ in range(count)])


def tiles(arguments, service, how, count):
    status, text = service.ask("/collections/dem/tiles/layer.json")
    if status != 200:
        print_row("tiles", text.decode()[:80], "", "", "")
        return
    layer = json.loads(text)
    chosen = random.Random(4)
    targets = []
    for _ in range(count):
        z = chosen.randrange(layer["maxzoom"] - 4, layer["maxzoom"] + 1)
        r = chosen.choice(layer["available"][z])
        x, y = chosen.randint(r["startX"], r["endX"]), chosen.randint(r["startY"], r["endY"])
        targets.append(f"/collections/dem/tiles/{z}/{x}/{y}.terrain")
    open_loop(arguments, service, f"quantized-mesh tile of the five finest levels, {how}", targets)


def heights(arguments, service, how, count):
    """Tiles of heights as colours, 256 x 256, PNG, of places drawn within the bounds, by zooms drawn among the five finest."""
    facts = json.loads(service.ask("/collections/dem/dem/tilejson.json?encoding=terrarium")[1])
    west, south, east, north = facts["bounds"]
    chosen = random.Random(4)
    targets = []
    for _ in range(count):
        z = chosen.randrange(max(0, facts["maxzoom"] - 4), facts["maxzoom"] + 1)
        x = (chosen.uniform(west, east) + 180) / 360
        y = 0.5 - math.asinh(math.tan(math.radians(chosen.uniform(south, north)))) / (2 * math.pi)
        targets.append(f"/collections/dem/dem/{z}/{int(x * 2**z)}/{int(y * 2**z)}.png?encoding=terrarium")
    open_loop(arguments, service, f"heights as colours of the five finest zooms, {how}", targets)


def flatness(arguments, service, places):
    targets = [mixed(places) for _ in range(20000)]
    with tempfile.NamedTemporaryFile("w") as file:
        file.write("\n".join(targets) + "\n")
        file.flush()
        rate = arguments.rate
        running = subprocess.Popen([arguments.serve_load, service.address, str(rate), str(arguments.requests / rate), "64",
                                    file.name], stdout=subprocess.PIPE, text=True)
        seen = []
        while running.poll() is None:
            time.sleep(2)
            seen.append(service.memory())
    later = seen[len(seen) // 4:]
    print(f"\n{arguments.requests} mixed questions, {rate}/s: {running.stdout.read().strip()}")
    print(f"memory without the file's pages, MiB: {later[0]:.0f} after a quarter, {later[-1]:.0f} at the end, "
          f"{max(seen):.0f} at most; {major_faults(service)} major faults")


def hang_ups(service, places):
    late = []
    pairs = [[*places.point(), 2, *places.point(), 2] for _ in range(1000)]
    body = json.dumps({"pairs": pairs, "crs": "native"})
    for _ in range(10):
        client = service.connect()
        client.sendall(f"POST /collections/dem/sight HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
                       f"Content-Length: {len(body)}\r\n\r\n{body}".encode())
        deadline = time.time() + 5
        while service.metric("ptin_computing") == 0 and time.time() < deadline:
            time.sleep(0.002)
        if service.metric("ptin_computing") == 0:
            sys.exit("the question was not computed")
        client.close()
        begin = time.perf_counter()
        while service.metric("ptin_computing") > 0:
            pass
        late.append(1e3 * (time.perf_counter() - begin))
    print(f"a client left: the service computed nothing after {max(late):.1f} ms at most, {statistics.median(late):.1f} mostly")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("ptin")
    parser.add_argument("serve_load")
    parser.add_argument("file")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--requests", type=int, default=100000)
    parser.add_argument("--seconds", type=int, default=8)
    parser.add_argument("--rate", type=int, default=400)
    parser.add_argument("--limit-memory")
    parser.add_argument("--repeated", action="store_true")
    arguments = parser.parse_args()
    facts = json.loads(subprocess.run([arguments.ptin, "info", arguments.file, "--json"], capture_output=True, check=True).stdout)
    places = Places(facts["bounds"], 1)

    def started(*options):
        threads = arguments.threads
        return Service(arguments.ptin, arguments.file, *options, threads=threads, cores=CORES[:threads])

    if arguments.repeated:
        limits = ("cache_bytes=0", "vertices=5000000", "question_memory=500000000", "computing=60000")
        service = started(*(word for limit in limits for word in ("--limit", limit)))
        repeated(service, facts["bounds"])
        print(f"ended with status {service.end()}")
        return
    service = started()
    if arguments.limit_memory:
        with open(arguments.file, "rb") as file:  # out of the page cache, to be read again by the service
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
        limit_memory(service, arguments.limit_memory)
        flatness(arguments, service, places)
        print(f"ended with status {service.end()}")
        return
    extent = json.loads(service.ask("/collections/dem")[1]).get("extent", {}).get("spatial", {}).get("bbox")
    lon_lat = None
    if extent:
        w, s, e, n = extent[0]
        lon_lat = Places({"min_x": w, "min_y": s, "max_x": e, "max_y": n}, 2)
    print_head("question", "throughput", "50 %, ms", "99 %, ms", "worst, ms")
    batches(arguments, service, places, lon_lat)
    meshes(arguments, service, places, "from the cache", 8)
    tiles(arguments, service, "from the cache", 32)
    heights(arguments, service, "from the cache", 32)
    bare = started("--limit", "cache_bytes=1")
    open_loop(arguments, bare, "one exact height", [position(places) for _ in range(20000)])
    meshes(arguments, bare, places, "made", 500)
    tiles(arguments, bare, "made", 3000)
    heights(arguments, bare, "made", 300)
    bare.end()
    flatness(arguments, service, places)
    hang_ups(service, places)
    print(f"ended with status {service.end()}")


if __name__ == "__main__":
    main()
