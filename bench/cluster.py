#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Predicts how long a build takes on a number of workers: a discrete-event simulation of the schedule
(engine/construct/tasks/task_schedule), fed with the times of tasks that bench/cluster_times measured.

usage: bench/cluster.py TIMES.jsonl [--workers N]... [--shared TIMES.jsonl]    the terrain that was measured
       bench/cluster.py TIMES.jsonl --scale [--disk MB/S]                      10^10 to 10^12 samples, as Markdown

--workers N     ranks besides rank 0, which directs: `mpirun -n N+1`
--shared FILE   times of the same build, measured while as many builds ran at once as there are workers: what they take from
                each other (caches, memory, the disk)
--disk MB/S     what the shared folder takes and gives, for all ranks together (default 2000)

The model of --scale: what a batch takes grows with its samples, what a tile above takes with what it reads, which grows
with its sides; constants are those of the measured build. It knows nothing of slow networks but --disk, of ranks that
differ, of batch systems that make jobs wait, and nothing of the memory that a larger tree takes at rank 0 but by the bytes
of a result there.
"""
import argparse
import heapq
import json
import math
import statistics

COLLAPSE, JOIN, TIGHTEN, CLOSE, PLACE = range(5)
NAMES = ["collapse", "join", "tighten", "close", "place"]
LATENCY = 0.002  # from a rank's answer to its next task, beyond the schedule: both sides look every two milliseconds
RESULT_BYTES = 700  # of a task that is done, in the memory of rank 0: a node of a map, names and facts


def parent(tile):
    return (tile[0] + 1, tile[1] // 2, tile[2] // 2)


class Tasks:
    """Of one build: times and bytes by (kind, tile), and batches in their order."""

    def __init__(self):
        self.seconds, self.schedule, self.bytes, self.memory = {}, {}, {}, {}
        self.batches, self.above = [], []
        self.stages = {}
        self.samples = 0

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
    ready, to_place = [], []
    has_pages, next_place = set(), 0
    running = []   # (end, key)
    idle = workers
    now, director = 0.0, 0.0  # the director does one thing at a time
    busy, ends = 0.0, {}
    is_collapsed = False

    def take():
        if to_place:
            return to_place.pop(0)
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
        self.tighten = sum_of(TIGHTEN, "seconds") / total
        self.join = sum_of(JOIN, "seconds") / sum_of(JOIN, "in")
        self.join_memory = max(j["memory"] / j["in"] for j in tasks.lines if j["task"] == JOIN)
        self.close = sum_of(CLOSE, "seconds") / sum_of(CLOSE, "in")
        self.close_pages = sum_of(CLOSE, "page_bytes") / sum_of(JOIN, "in")
        self.place = sum_of(PLACE, "seconds") / sum_of(PLACE, "in")
        self.schedule = {k: statistics.mean(j["schedule_seconds"] for j in tasks.lines if j["task"] == k) for k in range(5)}
        # Of a tile at level l: bytes a sample of its side, of what it pushes up, of its segment and of its raises.
        side = math.sqrt(statistics.median(samples.values()))
        self.pushed, self.segment, self.bounds = {}, {}, {}
        for level in range(1, levels + 1):
            long = side * 2 ** (level - 1)
            at = [j for (k, t), j in lines.items() if t[0] == level and k == (COLLAPSE if level == 1 else JOIN)]
            self.pushed[level] = max(j["files"][0] for j in at) / long
            if level > 1:
                self.segment[level] = max(j["files"][1] for j in at) / long
            at = [j for (k, t), j in lines.items() if t[0] == level and k == (TIGHTEN if level == 1 else CLOSE)]
            self.bounds[level] = max(j["files"][2] for j in at) / long
        # The highest two levels are small terrains' own: what lies below them grows with the sides.
        middle = max(1, levels - 2)
        self.pushed_side, self.bounds_side = self.pushed[middle], self.bounds[middle]
        self.segment_side = self.segment[max(2, middle)]
        self.publish = tasks.stages["publishing"] / total
        self.reading = tasks.stages["reading"] / total


def default_side(length):
    if length <= 16385:
        return 256
    return math.ceil(math.sqrt(4 * length) / 32) * 32


def made(model, samples):
    length = math.sqrt(samples)
    leaf = default_side(length)
    count = math.ceil((length - 1) / leaf)
    tasks = Tasks()
    segments_above = {}
    batches = math.ceil(count / 2)
    width = {1: batches}
    level = 1
    while width[level] > 1:
        width[level + 1] = math.ceil(width[level] / 2)
        level += 1
    levels = level
    for level in range(2, levels + 1):
        segments_above[level] = sum(model.segment_side * leaf * 2 ** l for l in range(level, levels + 1))
    batch = (2 * leaf) ** 2
    pushed = {level: model.pushed_side * leaf * 2 ** level for level in range(1, levels + 1)}

    def visit(level, x, y):
        if level == 1:
            tasks.add(COLLAPSE, (1, x, y), model.collapse * batch, model.schedule[COLLAPSE], model.collapse_out * batch,
                      model.collapse_memory * batch)
            moved = segments_above.get(2, 0)
            tasks.add(TIGHTEN, (1, x, y), model.tighten * batch, model.schedule[TIGHTEN], moved)
            pages = model.pages * batch
        else:
            for cy in (2 * y, 2 * y + 1):
                for cx in (2 * x, 2 * x + 1):
                    if cx < width[level - 1] and cy < width[level - 1]:
                        visit(level - 1, cx, cy)
            read = 4 * pushed[level - 1]
            segment = model.segment_side * leaf * 2 ** level
            tasks.add(JOIN, (level, x, y), model.join * read, model.schedule[JOIN], read + segment + pushed[level],
                      model.join_memory * read)
            bounds = 4 * model.bounds_side * leaf * 2 ** (level - 1)
            pages = model.close_pages * read
            tasks.add(CLOSE, (level, x, y), model.close * (segment + bounds), model.schedule[CLOSE], segment + bounds + pages)
        tasks.add(PLACE, (level, x, y), model.place * pages, model.schedule[PLACE], 2 * pages)

    visit(levels, 0, 0)
    tasks.samples = samples
    return tasks.finish()


def hours(seconds):
    return f"{seconds / 3600:.2f} h" if seconds >= 3600 else f"{seconds / 60:.1f} min"


def scale(measured, disk):
    model = Model(measured)
    print("| samples | workers | tasks | reading | tasks' time | publishing | all | speed-up | shared folder alone | of this path: joins, "
          "closings | memory a rank | at rank 0 |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    for power in (10, 11, 12):
        samples = 10 ** power
        tasks = made(model, samples)
        one = sum(tasks.seconds.values())
        moved = sum(tasks.bytes.values())
        path = critical_path(tasks)
        reading, publish = model.reading * samples, model.publish * samples
        memory = max(tasks.memory.values())
        at_zero = len(tasks.seconds) * RESULT_BYTES
        for workers in (16, 64, 256, 1024):
            seconds, _, _ = simulate(tasks, workers)
            whole = reading + max(seconds, moved / (disk * 1e6)) + publish
            print(f"| 10^{power} | {workers} | {len(tasks.seconds)} | {hours(reading)} | {hours(seconds)} | {hours(publish)} | "
                  f"{hours(whole)} | {(reading + one + publish) / whole:.0f} | {moved / 1e12:.2f} TB, {hours(moved / (disk * 1e6))} | "
                  f"{hours(path)} | {memory / 2 ** 30:.1f} GiB | {at_zero / 2 ** 20:.0f} MiB |", flush=True)


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
    print("| kind | tasks | seconds | in the schedule | MB |\n|---|---|---|---|---|")
    for kind in range(5):
        keys = measured.of_kind(kind)
        print(f"| {NAMES[kind]} | {len(keys)} | {sum(measured.seconds[k] for k in keys):.2f} | "
              f"{sum(measured.schedule[k] for k in keys):.3f} | {sum(measured.bytes[k] for k in keys) / 1e6:.1f} |")
    alone = sum(measured.stages[s] for s in ("reading", "opening", "publishing"))
    print(f"\nreading {measured.stages['reading']:.2f} s, opening {measured.stages['opening']:.2f} s, "
          f"publishing {measured.stages['publishing']:.2f} s, critical path {critical_path(measured):.2f} s\n")
    print("| workers | tasks' time | all | workers at work |\n|---|---|---|---|")
    for workers in arguments.workers or [1, 2, 4]:
        tasks = shared if shared and workers > 1 else measured
        seconds, busy, _ = simulate(tasks, workers)
        print(f"| {workers} | {seconds:.2f} s | {seconds + alone:.2f} s | {100 * busy / seconds / workers:.0f} % |")


if __name__ == "__main__":
    main()
