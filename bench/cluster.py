#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Predicts how long a build takes on a number of workers: a discrete-event simulation of the schedule
(engine/construct/tile_tasks/tile_schedule), fed with the times of tasks that bench/cluster_times measured.

usage: bench/cluster.py TIMES.jsonl [--workers N]... [--shared TIMES.jsonl]    the terrain that was measured
       bench/cluster.py TIMES.jsonl --scale [--disk MB/S]                      10^10 to 10^12 samples, as Markdown

--workers N     ranks besides rank 0, which directs: `mpirun -n N+1`
--shared FILE   times of the same build, measured while as many builds ran at once as there are workers: what they take from
                each other (caches, memory, the disk)
--disk MB/S     what the shared folder takes and gives, for all ranks together (default 2000)

The model of --scale: what a batch takes and pushes up grows with its samples, what a tile above takes with what it reads;
from level to level that grows as in the measured build. The first tile of each size is the default one. It knows nothing of slow networks but --disk, of ranks that
differ, of batch systems that make jobs wait, and nothing of the memory that a larger tree takes at rank 0 but by the bytes
of a result there.
"""
import argparse
import collections
import heapq
import json
import math
import statistics

from support.markdown import print_head, print_row, print_table

COLLAPSE, JOIN, TIGHTEN, CLOSE, PLACE = range(5)
NAMES = ["collapse", "join", "tighten", "close", "place"]
LATENCY = 0.002  # from a rank's answer to its next task, beyond the schedule: both sides look at least every two milliseconds
SCAN = 1e-9  # seconds a byte of the segments above a batch: checked once, looked through for each leaf; estimated, not measured
RESULT_BYTES = 700  # of a task that is done, in the memory of rank 0: a node of a map, names and facts
BAND_SAMPLES = 2 ** 22  # of a task of the first reading (engine/construct/raster/raster_scan.h)


def parent(tile):
    return (tile[0] + 1, tile[1] // 2, tile[2] // 2)


class Tasks:
    """Of one build: times and bytes by (kind, tile), and batches in their order."""

    def __init__(self):
        self.seconds, self.schedule, self.bytes, self.memory = {}, {}, {}, {}
        self.batches, self.above = [], []
        self.stages = {}
        self.samples = 0
        self.scheduling = self.processor = math.nan

    def add(self, kind, tile, seconds, schedule, moved, memory=0):
        key = (kind, tile)
        self.seconds[key], self.schedule[key], self.bytes[key], self.memory[key] = seconds, schedule, moved, memory
        if kind == COLLAPSE:
            self.batches.append(tile)
        elif kind == JOIN:
            self.above.append(tile)

    def finish(self):
        self.root = max(self.above, default=self.batches[0])
        self.children = {}
        for tile in self.batches + self.above:
            if tile != self.root:
                self.children.setdefault(parent(tile), []).append(tile)
        # The place in the output: batches, then tiles above behind their last batch.
        order = list(self.batches)

        def visit(tile):
            for child in sorted(self.children.get(tile, []), key=lambda t: (t[2], t[1])):
                visit(child)
            if tile[0] > 1:
                order.append(tile)
        visit(self.root)
        self.output = order
        return self

    def of_kind(self, kind):
        return [key for key in self.seconds if key[0] == kind]


def read(path):
    tasks, order, stages = Tasks(), [], {}
    with open(path) as lines:
        for line in lines:
            j = json.loads(line)
            if "task" in j:
                order.append(j)
                tasks.add(j["task"], tuple(j["tile"]), j["seconds"], j["schedule_seconds"], j["in"] + j["out"], j["memory"])
            elif "stage" in j:
                stages[j["stage"]] = j["seconds"]
            elif "scheduling" in j:
                tasks.scheduling, tasks.processor = j["scheduling"], j["processor"]
            else:
                tasks.samples = j["samples"]
                stages["total"] = j["total"]
    tasks.stages = stages
    tasks.lines = order
    return tasks.finish()


def simulate(tasks, workers):
    """Seconds from the first task to the last, and what was going on: the schedule's own rules."""
    order = {tile: i for i, tile in enumerate(tasks.batches)}
    collapse, tighten = list(reversed(tasks.batches)), list(reversed(tasks.batches)) if tasks.above else []
    missing = {(JOIN, tile): len(tasks.children[tile]) for tile in tasks.above}
    missing.update({(CLOSE, tile): len(tasks.children[tile]) for tile in tasks.above})
    ready, to_place = [], collections.deque()
    has_pages, next_place = set(), 0
    running = []   # (end, key)
    idle = workers
    now, director = 0.0, 0.0  # the director does one thing at a time
    busy, ends = 0.0, {}
    is_collapsed = False

    def take():
        if to_place:
            return to_place.popleft()
        if ready:
            return heapq.heappop(ready)
        if collapse:
            return (COLLAPSE, collapse.pop())
        if tighten and is_collapsed:
            return (TIGHTEN, tighten.pop())
        return None

    while True:
        while idle:
            key = take()
            if key is None:
                break
            begin = max(now, director) + LATENCY
            heapq.heappush(running, (begin + tasks.seconds[key], key))
            busy += tasks.seconds[key]
            idle -= 1
        if not running:
            return max(now, director), busy, ends
        now, key = heapq.heappop(running)
        director = max(director, now) + tasks.schedule[key]
        now = director
        idle += 1
        kind, tile = key
        ends[kind] = now
        if kind in (COLLAPSE, JOIN):
            if tile == tasks.root:
                is_collapsed = True
            elif kind == COLLAPSE or tile[0] > 1:
                missing[(JOIN, parent(tile))] -= 1
                if missing[(JOIN, parent(tile))] == 0:
                    heapq.heappush(ready, (JOIN, parent(tile)))
        if kind in (TIGHTEN, CLOSE) and tile != tasks.root:
            missing[(CLOSE, parent(tile))] -= 1
            if missing[(CLOSE, parent(tile))] == 0:
                heapq.heappush(ready, (CLOSE, parent(tile)))
        if kind in (COLLAPSE, CLOSE):
            has_pages.add(tile)
            while next_place < len(tasks.output) and tasks.output[next_place] in has_pages:
                to_place.append((PLACE, tasks.output[next_place]))
                next_place += 1


def critical_path(tasks):
    """Joins one above the other and closings likewise, with one batch before each."""
    longest = {}
    total = 0.0
    for first, above in ((COLLAPSE, JOIN), (TIGHTEN, CLOSE)):
        for tile in tasks.batches:
            longest[tile] = tasks.seconds.get((first, tile), 0.0)
        for tile in sorted(tasks.above):
            longest[tile] = max(longest[c] for c in tasks.children[tile]) + tasks.seconds[(above, tile)]
        total += longest[tasks.root]
    return total


# ---------------------------------------------------------------------------------------------------------------------
# Terrains that nobody measured.

class Model:
    """Constants of a measured build."""

    def __init__(self, tasks):
        samples = {tuple(j["tile"]): j["samples"] for j in tasks.lines if j["task"] == COLLAPSE}
        lines = {(j["task"], tuple(j["tile"])): j for j in tasks.lines}
        total = sum(samples.values())
        levels = tasks.root[0]

        def sum_of(kind, field):
            return sum(j[field] for j in tasks.lines if j["task"] == kind)

        self.collapse = sum_of(COLLAPSE, "seconds") / total
        self.pages = sum_of(COLLAPSE, "page_bytes") / total
        self.collapse_out = sum_of(COLLAPSE, "out") / total
        self.collapse_memory = max(j["memory"] for j in tasks.lines if j["task"] == COLLAPSE) / max(samples.values())
        self.tighten = (sum_of(TIGHTEN, "seconds") - SCAN * sum_of(TIGHTEN, "in")) / total
        self.join = sum_of(JOIN, "seconds") / sum_of(JOIN, "in")
        self.join_memory = max(j["memory"] / j["in"] for j in tasks.lines if j["task"] == JOIN)
        self.close = sum_of(CLOSE, "seconds") / sum_of(CLOSE, "in")
        self.close_pages = sum_of(CLOSE, "page_bytes") / sum_of(JOIN, "in")
        self.place = sum_of(PLACE, "seconds") / sum_of(PLACE, "in")
        self.schedule = {k: statistics.mean(j["schedule_seconds"] for j in tasks.lines if j["task"] == k) for k in range(5)}
        # What a batch pushes up grows with its samples; each level above pushes up a little more than the one below.
        def mean_of(level, kind, file):
            at = [j["files"][file] for (k, t), j in lines.items() if t[0] == level and k == kind]
            return statistics.mean(at)

        self.pushed = mean_of(1, COLLAPSE, 0) / (total / len(samples))
        self.bounds = mean_of(1, TIGHTEN, 2) / (total / len(samples))
        below = {level: mean_of(level, JOIN, 0) for level in range(2, levels)}  # the root pushes up T0 alone
        self.growth = (max(below.values()) * len(samples) / sum(j["files"][0] for j in tasks.lines if j["task"] == COLLAPSE)) ** (
            1 / max(1, levels - 2))
        inner = [j for (k, t), j in lines.items() if k == JOIN and t[0] < levels]
        self.segment = sum(j["files"][1] for j in inner) / sum(j["in"] for j in inner)
        self.publish = tasks.stages["publishing"] / total
        self.reading = tasks.stages["reading"] / total


def made(model, samples, leaf):
    count = math.ceil((math.sqrt(samples) - 1) / leaf)
    tasks = Tasks()
    width = [0, math.ceil(count / 2)]
    while width[-1] > 1:
        width.append(math.ceil(width[-1] / 2))
    levels = len(width) - 1
    batch = (2 * leaf) ** 2
    pushed = [0] + [model.pushed * batch * model.growth ** level for level in range(levels)]
    raises = [0] + [model.bounds * batch * model.growth ** level for level in range(levels)]
    segment = [0, 0] + [4 * pushed[level - 1] * model.segment for level in range(2, levels + 1)]

    def visit(level, x, y):
        if level == 1:
            tasks.add(COLLAPSE, (1, x, y), model.collapse * batch, model.schedule[COLLAPSE], model.collapse_out * batch,
                      model.collapse_memory * batch)
            above = sum(segment)
            tasks.add(TIGHTEN, (1, x, y), model.tighten * batch + SCAN * above, model.schedule[TIGHTEN], above)
            pages = model.pages * batch
        else:
            for cy in (2 * y, 2 * y + 1):
                for cx in (2 * x, 2 * x + 1):
                    if cx < width[level - 1] and cy < width[level - 1]:
                        visit(level - 1, cx, cy)
            read = 4 * pushed[level - 1]
            tasks.add(JOIN, (level, x, y), model.join * read, model.schedule[JOIN], read + segment[level] + pushed[level],
                      model.join_memory * read)
            read_again = segment[level] + 4 * raises[level - 1]
            pages = model.close_pages * read
            tasks.add(CLOSE, (level, x, y), model.close * read_again, model.schedule[CLOSE], read_again + pages)
        tasks.add(PLACE, (level, x, y), model.place * pages, model.schedule[PLACE], 2 * pages)

    visit(levels, 0, 0)
    tasks.samples = samples
    return tasks.finish()


def hours(seconds):
    return f"{seconds / 3600:.2f} h" if seconds >= 3600 else f"{seconds / 60:.1f} min"


def scale(measured, disk):
    model = Model(measured)
    facts, times = [], []
    for power, leaf in ((10, 640), (10, 256), (11, 1152), (11, 512), (12, 2016), (12, 1024)):
        samples = 10 ** power
        tasks = made(model, samples, leaf)
        # Segments above a batch are read for every batch, but lie in the cache of the machine that did the one before.
        again = sum(tasks.bytes[key] for key in tasks.of_kind(TIGHTEN))
        moved = sum(tasks.bytes.values()) - again
        reading, publish, folder = model.reading * samples, model.publish * samples, moved / (disk * 1e6)
        one = sum(tasks.seconds.values())
        facts.append([f"10^{power}", leaf, len(tasks.seconds), hours(reading), hours(one), hours(publish), hours(critical_path(tasks)),
                      hours(sum(tasks.schedule.values())), f"{moved / 1e12:.2f} TB, {hours(folder)}", f"{again / 1e12:.2f} TB",
                      f"{max(tasks.memory.values()) / 2 ** 30:.1f} GiB", f"{len(tasks.seconds) * RESULT_BYTES / 2 ** 20:.0f} MiB"])
        row = [f"10^{power}", leaf]
        for workers in (16, 64, 256, 1024):
            seconds, _, _ = simulate(tasks, workers)
            bands = math.ceil(samples / BAND_SAMPLES)
            whole = reading * math.ceil(bands / workers) / bands + max(seconds, folder) + publish
            slow = " (folder)" if folder > seconds else ""
            row.append(f"{hours(whole)}, {(reading + one + publish) / whole:.0f}{slow}")
        times.append(row)
    print_table(("samples", "tile", "tasks", "reading, one after the other", "tasks, one after the other", "publishing, rank 0",
                 "longest path of joins and closings", "in the schedule, rank 0", "moved through the folder", "segments read again",
                 "memory of the largest task", "results at rank 0"), facts)
    print()
    print_table(("samples", "tile", "16 workers: all, speed-up", "64", "256", "1024"), times)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1])
    parser.add_argument("times")
    parser.add_argument("--workers", type=int, action="append")
    parser.add_argument("--shared")
    parser.add_argument("--scale", action="store_true")
    parser.add_argument("--disk", type=float, default=2000)
    arguments = parser.parse_args()
    measured = read(arguments.times)
    if arguments.scale:
        scale(measured, arguments.disk)
        return
    shared = read(arguments.shared) if arguments.shared else None
    print_head("kind", "tasks", "seconds", "in the schedule", "MB")
    for kind in range(5):
        keys = measured.of_kind(kind)
        print_row(NAMES[kind], len(keys), f"{sum(measured.seconds[k] for k in keys):.2f}",
                  f"{sum(measured.schedule[k] for k in keys):.3f}", f"{sum(measured.bytes[k] for k in keys) / 1e6:.1f}")
    alone = sum(measured.stages[s] for s in ("reading", "opening", "publishing"))
    print(f"\nreading {measured.stages['reading']:.2f} s, opening {measured.stages['opening']:.2f} s, "
          f"publishing {measured.stages['publishing']:.2f} s, critical path {critical_path(measured):.2f} s; "
          f"processor in the schedule {measured.scheduling:.2f} s of {measured.processor:.2f} s, "
          f"{100 * measured.scheduling / measured.processor:.2f} %\n")
    print_head("workers", "tasks' time", "all", "workers at work")
    for workers in arguments.workers or [1, 2, 4]:
        tasks = shared if shared and workers > 1 else measured
        seconds, busy, _ = simulate(tasks, workers)
        print_row(workers, f"{seconds:.2f} s", f"{seconds + alone:.2f} s", f"{100 * busy / seconds / workers:.0f} %")


if __name__ == "__main__":
    main()
