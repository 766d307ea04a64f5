#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds of terrains larger than memory: memory, disk, traffic and time of whole `ptin build` runs.

usage: bench/large_builds.py PTIN FOLDER INPUT... [--memory SIZE]... [--threads N]... [-- BUILD OPTIONS]

One Markdown row a run: every input with every memory and every number of threads. FOLDER takes the output
and the temporary files and needs about three times the output; each output is removed before the next run.

anonymous   largest RssAnon of /proc/PID/status, sampled every 10 ms: what `--memory` promises
disk        largest sum of blocks of all files of the build (temporary ones, and the output as it grows) that
            is not the finished output; sampled ten times a second
traffic     bytes that system calls read and wrote (rchar, wchar of /proc/PID/io), and bytes of temporary files read
            through mappings are not among them: so (read_bytes + write_bytes), what really reached the disk, is told too
"""
import argparse
import json
import os
import subprocess
import sys
import time

from support.markdown import print_head, print_row


def blocks(folder, skip):
    total = 0
    for path, _, names in os.walk(folder):
        for name in names:
            if os.path.join(path, name) in skip:
                continue
            try:
                total += os.lstat(os.path.join(path, name)).st_blocks * 512
            except OSError:  # removed since it was listed
                pass
    return total


def status_kib(pid, field):
    try:
        with open(f"/proc/{pid}/status") as lines:
            for line in lines:
                if line.startswith(field + ":"):
                    return int(line.split()[1])
    except OSError:
        pass
    return 0


def traffic(pid):
    try:
        with open(f"/proc/{pid}/io") as lines:
            return {k: int(v) for k, v in (line.strip().split(": ") for line in lines)}
    except OSError:
        return {}


def run(ptin, folder, source, memory, threads, options):
    output = os.path.join(folder, "large.ptin")
    if os.path.exists(output):
        os.remove(output)
    before = blocks(folder, {source})
    command = [ptin, "build", source, "-o", output, "--memory", memory, "--threads", str(threads)] + options
    started = time.monotonic()
    with open(os.path.join(folder, "large_builds.log"), "w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log)
    anonymous = disk = ticks = 0
    io = {}
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        anonymous = max(anonymous, status_kib(process.pid, "RssAnon"))
        io = traffic(process.pid) or io
        if ticks % 10 == 0:
            disk = max(disk, blocks(folder, {source, output}) - before)
        ticks += 1
        time.sleep(0.01)
    seconds = time.monotonic() - started
    if status != 0:
        with open(os.path.join(folder, "large_builds.log")) as log:
            sys.exit(f"{' '.join(command)} failed:\n{log.read()[-2000:]}")
    facts = json.loads(subprocess.run([ptin, "info", output, "--json"], check=True, capture_output=True).stdout)
    vertices = facts["vertices"]
    size_in, size_out = os.stat(source).st_size, os.stat(output).st_size
    processor = usage.ru_utime + usage.ru_stime
    gib = 1 << 30
    row = [
        os.path.basename(source), f"{vertices / 1e6:.1f} M", memory, threads, f"{anonymous / 1024:.0f} MiB",
        f"{size_out / gib:.2f} GiB", f"{disk / size_out:.2f}",
        f"{(io['rchar'] + io['wchar']) / (size_in + size_out):.2f}",
        f"{(io['read_bytes'] + io['write_bytes']) / (size_in + size_out):.2f}",
        f"{seconds:.0f} s", f"{processor:.0f} s", f"{vertices / processor / 1e3:.0f} k",
    ]
    os.remove(output)
    return row


def main():
    options = []
    arguments = sys.argv[1:]
    if "--" in arguments:
        at = arguments.index("--")
        arguments, options = arguments[:at], arguments[at + 1:]
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("ptin")
    parser.add_argument("folder")
    parser.add_argument("inputs", nargs="+")
    parser.add_argument("--memory", action="append")
    parser.add_argument("--threads", action="append", type=int)
    a = parser.parse_args(arguments)
    os.makedirs(a.folder, exist_ok=True)
    print_head("input", "vertices", "--memory", "threads", "anonymous", "output", "temporary disk / output",
               "system calls' traffic / (input + output)", "disk's traffic / (input + output)", "clock", "processor",
               "vertices/s of processor")
    for source in a.inputs:
        for memory in a.memory or ["256M"]:
            for threads in a.threads or [1]:
                print_row(*run(a.ptin, a.folder, source, memory, threads, options))


if __name__ == "__main__":
    main()
