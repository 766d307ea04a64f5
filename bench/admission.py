#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How late cheap questions of `ptin serve` are beside dear ones, hostile bodies, idle connections and attacks.

usage: bench/admission.py PTIN FILE [--threads N] [--seconds S] [--attacks] [--connections N] [--only NAME ...]

Starts the service on FILE over loopback for each row. Other clients come from 127.0.0.2 and on, as the client that is measured
comes from 127.0.0.1, and from another process: 40 heights a second, each by a new connection, its time counted from when it was due, and /healthz eight
times a second. A row has statuses, percentiles in milliseconds, and memory without the file's pages: at the start, at most, and
two seconds after the others have their last answers. A row whose others were not answered what they are there for tests nothing:
the status is 1 then. With --attacks the others are slow, greedy and broken clients (support/attacks.py), N of them (1000 at most)
from the address of the client that is measured, and the service gives its file away too (--files); the status is 1 where one of
them keeps a question of that client from its answer, or for 5 seconds.
"""
import argparse
import collections
import http.client
import json
import multiprocessing
import shutil
import socket
import subprocess
import sys
import threading
import time

from support.attacks import ATTACKS
from support.markdown import print_head, print_row
from support.service import Service


def guarded(act):
    try:
        return act()
    except (OSError, http.client.HTTPException) as error:
        return type(error).__name__


def repeat(service, stop, counts, k, target, body):
    """Asks from one of 50 addresses; no two questions are alike, which would be answered from memory."""
    i = 0
    while not stop.is_set():
        counts[guarded(lambda: service.ask(target.replace("@", f"{k:02}{i:06}"), body, 1 + k % 50)[0])] += 1
        i += 1


def others(number, target, body=None):
    """So many clients that ask again and again."""
    def start(service, stop, counts):
        for k in range(number):
            threading.Thread(target=repeat, daemon=True, args=(service, stop, counts, k, target, body and body(k))).start()
    return start


def idle(number):
    def start(service, stop, counts):
        held = [guarded(lambda: service.connect(1)) for _ in range(number)]
        counts["connections"] += sum(isinstance(one, socket.socket) for one in held)
        threading.Thread(target=lambda: (stop.wait(), [one.close() for one in held if isinstance(one, socket.socket)]),
                         daemon=True).start()
    return start


SHAPES = [b'{"pairs":[' + b"{}," * 349000 + b"1]}", b'{"pairs":[' + b"[]," * 349000 + b"1]}", b"[" * 1000000,
          b'{"pairs":[' + b'{"":0},' * 140000 + b"1]}", b'{"a":"' + b"\\u00e9" * 170000 + b'"}', b'{"a":' + b"1" * 1000000 + b"}",
          b"{" + b",".join(b'"k%d":0' % i for i in range(90000)) + b"}"]
SHED = "/collections/dem/viewshed?coords={}&radius={}&height=2.@"
STREAM = "/collections/dem/stream?error=0.@&max_bytes=4000000"
SIGHT = "/collections/dem/sight"


def rows(shed):
    """Each with what the others are to be told at least once, and may be told beside it."""
    hostile = [(f"{n} hostile bodies", others(n, SIGHT, lambda k: SHAPES[k % len(SHAPES)]), {413}, {400, 503}) for n in (2, 20)]
    return ([("nothing", None, set(), set())] + [(f"{n} streams", others(n, STREAM), {200}, {503}) for n in (1, 2, 8, 80)] +
            [(f"{n} viewsheds", others(n, shed), {200}, {503}) for n in (1, 2, 8, 80)] + hostile +
            [("1024 idle connections", idle(1024), {"connections"}, set()),
             ("300 descriptors, 600 idle", idle(600), {"connections"}, set())])


def attack_rows(seconds, connections):
    def start_of(attack):
        return lambda service, stop, counts: threading.Thread(target=attack, args=(service, seconds, connections)).start()
    return [(name, start_of(attack), set(), set()) for name, attack in ATTACKS.items()
            if shutil.which("slowhttptest") or not name.startswith("slowhttptest")]


def answered_viewshed(service, middle):
    """The widest one that the service answers."""
    for radius in (20000, 10000, 5000, 2000, 1000):
        shed = SHED.format(middle, radius)
        if service.ask(shed.replace("@", "0"))[0] == 200:
            return radius, shed
    sys.exit("no viewshed of this terrain is answered")


def crowd(service, start, stop, told):
    counts = collections.Counter()
    before = set(threading.enumerate())
    start(service, stop, counts)
    stop.wait()
    for thread in set(threading.enumerate()) - before:
        thread.join()
    told.put(counts)


def measure(service, place, seconds, start):
    stop, told = multiprocessing.Event(), multiprocessing.Queue()
    before = most = service.memory()
    if start:
        # A process of its own: else those who measure would wait for those who crowd.
        multiprocessing.Process(target=crowd, args=(service, start, stop, told), daemon=True).start()
        time.sleep(0.5)
    found = {"heights": [], "healthz": []}

    def one(kind, target, due):
        status = guarded(lambda: service.ask(target)[0])
        found[kind].append((1e3 * (time.monotonic() - due), status))

    begin, asked = time.monotonic(), []
    for i in range(40 * seconds):
        due = begin + i / 40
        time.sleep(max(0, due - time.monotonic()))
        jobs = [("heights", place)] + ([("healthz", "/healthz")] if i % 5 == 0 else [])
        for kind, target in jobs:
            asked.append(threading.Thread(target=one, args=(kind, target, due)))
            asked[-1].start()
        most = max(most, service.memory())
    for job in asked:
        job.join()
    stop.set()
    counts = told.get() if start else collections.Counter()
    time.sleep(2)
    return found, counts, (before, most, service.memory())


def table_row(name, found, counts, memory):
    cells = [name]
    for kind in ("heights", "healthz"):
        times = sorted(t for t, _ in found[kind])
        statuses = collections.Counter(s for _, s in found[kind])
        cells.append(" ".join(f"{n} x {s}" for s, n in sorted(statuses.items(), key=str)))
        cells.append(" / ".join(f"{times[min(len(times) - 1, int(len(times) * q))]:.0f}" for q in (0.5, 0.99, 1)))
    cells.append(" ".join(f"{n} x {s}" for s, n in sorted(counts.items(), key=str)))
    cells.append(" / ".join(f"{m:.0f}" for m in memory))
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ptin")
    parser.add_argument("file")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seconds", type=int, default=5)
    parser.add_argument("--attacks", action="store_true")
    parser.add_argument("--connections", type=int, default=900)
    parser.add_argument("--only", nargs="*")
    options = parser.parse_args()
    facts = json.loads(subprocess.run([options.ptin, "info", options.file, "--json"], capture_output=True, check=True).stdout)
    west, south, east, north = facts["bounds"] if isinstance(facts["bounds"], list) else [
        facts["bounds"][k] for k in ("min_x", "min_y", "max_x", "max_y")]
    middle = f"POINT({(west + east) / 2}%20{(south + north) / 2})&crs=native"
    place = f"/collections/dem/position?coords={middle}"
    if options.attacks:
        chosen = attack_rows(min(options.seconds, 60), min(options.connections, 1000))
    else:
        service = Service(options.ptin, options.file, threads=options.threads)
        radius, shed = answered_viewshed(service, middle)
        service.end()
        chosen = rows(shed)
        print(f"Viewsheds have a radius of {radius}.\n")
    print_head("beside", "heights", "50 % / 99 % / most, ms", "healthz", "50 % / 99 % / most, ms", "what the others got",
               "MiB before / most / after")
    failed, succeeded = [], []
    for name, start, needed, allowed in chosen:
        if options.only and name not in options.only:
            continue
        service = Service(options.ptin, options.file, *(["--files"] if options.attacks else []), threads=options.threads,
                          descriptors=300 if "descriptors" in name else None)
        service.ask(place)
        found, counts, memory = measure(service, place, options.seconds, start)
        print_row(*table_row(name, found, counts, memory))
        if not needed <= set(counts) <= needed | allowed:
            failed.append(name)
        if options.attacks and any(status != 200 or ms > 5000 for answers in found.values() for ms, status in answers):
            succeeded.append(name)
        service.end()
    if succeeded:
        sys.exit(f"not all heights and /healthz were answered beside {', '.join(succeeded)}")
    if failed:
        sys.exit(f"not answered what they are there for: the others of {', '.join(failed)}")


if __name__ == "__main__":
    main()
