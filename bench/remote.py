#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What questions of a file that lies elsewhere cost: rounds, requests, bytes and time, over a server that makes each
request wait.

usage: bench/remote.py PTIN STORE [--delay SECONDS] [--points N] [--check]

The server (tests/support/range_server.py) runs here, so there is a delay and no limit of bandwidth. Costs are told by
the program and held against what the server counted. `used` is what the same
question looks at in a local file: its pages and nodes, and 64 KiB for the front. `one after the other` is the same
question where GDAL reads the same ranges one by one (/vsisubfile/ over /vsicurl/). With --check the bounds of the table
are held, and a breach ends with status 1.
"""
import argparse
import json
import os
import random
import re
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request

from support.markdown import print_table
from support.service import Service

SERVER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "support", "range_server.py")


class Bench:
    def __init__(self, ptin, store, delay, folder):
        self.ptin, self.store, self.delay, self.folder = ptin, store, delay, folder
        self.server = subprocess.Popen(
            [sys.executable, SERVER, os.path.dirname(os.path.abspath(store)), "--delay", str(delay)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.base = f"http://127.0.0.1:{self.server.stdout.readline().strip()}"
        self.url = f"{self.base}/plain/{os.path.basename(store)}"
        self.rows, self.breaches = [], []

    def close(self):
        self.server.stdin.close()
        self.server.wait()

    def counts(self):
        return json.load(urllib.request.urlopen(self.base + "/reset"))

    def run(self, *words):
        return json.loads(subprocess.run([self.ptin, *words, "--json"], check=True, capture_output=True).stdout)

    def ask(self, command, *words):
        """The cost of one cold question: of the opening and the answer."""
        near = self.run(command, self.store, *words).get("cost", {})
        self.counts()
        begin = time.monotonic()
        self.run(command, "/vsisubfile/0,/vsicurl/" + self.url, *words)
        singly = time.monotonic() - begin
        requests_singly = self.counts()["requests"]
        begin = time.monotonic()
        far = self.run(command, self.url, *words).get("cost", {})
        seconds = time.monotonic() - begin
        counted = self.counts()
        if far and counted["requests"] != far["remote_requests"] + 1:
            sys.exit(f"the server counted {counted['requests']} requests, the program {far['remote_requests'] + 1}")
        return {"rounds": far.get("remote_rounds", 0) + 1, "requests": counted["requests"], "bytes": counted["bytes"],
                "most": counted["most"], "seconds": seconds,
                "used": near.get("bytes_read", 0) + 65536, "singly": singly, "requests_singly": requests_singly}

    def add(self, name, asked, limits=None):
        def middle(key):
            return statistics.median(a[key] for a in asked)

        row = [name, f"{middle('rounds'):g}", f"{max(a['rounds'] for a in asked)}", f"{middle('requests'):g}",
               f"{middle('bytes') / 1024:.0f}",
               f"{middle('used') / 1024:.0f}" if middle("used") else "", f"{middle('seconds'):.2f} s",
               f"{middle('requests_singly'):g}: {middle('singly'):.1f} s" if middle("singly") else ""]
        self.rows.append(row)
        for key, limit in (limits or {}).items():
            if middle(key) > limit:
                self.breaches.append(f"{name}: {key} {middle(key):g}, above {limit}")

    def points(self, count, bounds):
        asked = []
        for _ in range(count):
            path = os.path.join(self.folder, "point.csv")
            with open(path, "w") as file:
                x = random.uniform(bounds["min_x"], bounds["max_x"])
                y = random.uniform(bounds["min_y"], bounds["max_y"])
                file.write(f"x,y\n{x!r},{y!r}\n")
            asked.append(self.ask("locate", "--points", path))
        return asked

    def windows(self, count, bounds, share, *words):
        asked = []
        for i in range(count):
            width = (bounds["max_x"] - bounds["min_x"]) * share**0.5
            height = (bounds["max_y"] - bounds["min_y"]) * share**0.5
            x = random.uniform(bounds["min_x"], bounds["max_x"] - width)
            y = random.uniform(bounds["min_y"], bounds["max_y"] - height)
            window = ["--window", repr(x), repr(y), repr(x + width), repr(y + height)]
            if words[0] == "highest":
                asked.append(self.ask(*words, *window))
            else:
                output = os.path.join(self.folder, f"w{len(self.rows)}_{i}" + words[-1])
                asked.append(self.ask(*words[:-1], *window, "-o", output, "--overwrite"))
        return asked

    def second_points(self, count, bounds):
        """A point beside one that was asked for before, of one opened file: by the service."""
        service = Service(self.ptin, self.url, threads=os.cpu_count())
        asked = []
        for _ in range(count):
            x = random.uniform(bounds["min_x"], bounds["max_x"])
            y = random.uniform(bounds["min_y"], bounds["max_y"])
            step = (bounds["max_x"] - bounds["min_x"]) / 1e3
            for dx in (0.0, step):
                self.counts()
                begin = time.monotonic()
                url = f"http://{service.address}/collections/dem/position?coords=POINT({x + dx!r}%20{y!r})&crs=native"
                with urllib.request.urlopen(url) as answer:
                    told = re.search(r"remote_rounds=(\d+)", answer.headers.get("Server-Timing", ""))
                seconds = time.monotonic() - begin
                counted = self.counts()
                if dx:
                    asked.append({"rounds": int(told[1]) if told else 0, "requests": counted["requests"], "bytes": counted["bytes"],
                                  "most": counted["most"], "seconds": seconds, "used": 0, "singly": 0, "requests_singly": 0})
        service.end()
        return asked


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("ptin")
    parser.add_argument("store")
    parser.add_argument("--delay", type=float, default=0.05)
    parser.add_argument("--points", type=int, default=20)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    random.seed(20260229)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(arguments.ptin, arguments.store, arguments.delay, folder)
        bounds = bench.run("info", arguments.store)["bounds"]
        n = arguments.points
        few = max(n // 4, 1)
        kib = 1024
        bench.add("open (`info`)", [bench.ask("info") for _ in range(few)], {"rounds": 1, "requests": 1})
        bench.add("a point, cold", bench.points(n, bounds), {"rounds": 3, "requests": 12, "bytes": 128 * kib})
        bench.add("a point beside one asked for before", bench.second_points(few, bounds), {"rounds": 1})
        bench.add("all of a window of 1/1000 (`refine --clip`)",
                  bench.windows(few, bounds, 1e-3, "refine", "--clip", ".ply"), {"rounds": 3, "requests": 24})
        bench.add("the same within 20", bench.windows(few, bounds, 1e-3, "refine", "--clip", "--error", "20", ".ply"))
        bench.add("isolines of a window of 1/1000",
                  bench.windows(few, bounds, 1e-3, "isoline", "--interval", "50", ".geojson"))
        bench.add("the highest point of a window of 1/10", bench.windows(few, bounds, 0.1, "highest"))
        bench.add("a picture of the whole within 50",
                  [bench.ask("render", "--error", "50", "-o", os.path.join(folder, "p.png"), "--overwrite")])
        bench.close()
    print_table(("question", "rounds, median", "most", "requests", "KiB", "KiB used", "time",
                 "one after the other: requests, time"), bench.rows)
    for breach in bench.breaches:
        print(breach, file=sys.stderr)
    sys.exit(1 if arguments.check and bench.breaches else 0)


if __name__ == "__main__":
    main()
