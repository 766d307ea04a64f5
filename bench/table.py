#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns what a benchmark wrote into a Markdown table: medians and cv of a Google Benchmark JSON, or a CSV as it is.

usage: table.py FILE.json|FILE.csv
"""
import csv
import json
import sys

from support.markdown import print_table

BUILT_IN = {"name", "run_name", "run_type", "repetitions", "repetition_index", "threads", "aggregate_name", "aggregate_unit",
            "iterations", "real_time", "cpu_time", "time_unit", "family_index", "per_family_instance_index", "label",
            "error_occurred", "error_message"}


def short(value):
    if not isinstance(value, (int, float)):
        return str(value)
    return f"{value:,.0f}".replace(",", " ") if abs(value) >= 1000 else f"{value:.4g}"


def print_json(path):
    with open(path) as file:
        runs = json.load(file)["benchmarks"]
    cv = {r["run_name"]: r for r in runs if r.get("aggregate_name") == "cv"}
    rows = []
    for r in runs:
        if r.get("error_occurred"):
            rows.append([r["run_name"], "skipped: " + r["error_message"], "", "", ""])
        elif r.get("aggregate_name") == "median":
            spread = cv.get(r["run_name"], {}).get("cpu_time", 0)
            counters = ", ".join(f"{k} {short(v)}" for k, v in r.items() if k not in BUILT_IN)
            rows.append([r["run_name"].replace("/process_time", "").replace("/iterations:1", "").replace("/real_time", ""),
                         short(r["cpu_time"]) + " " + r["time_unit"], short(r["real_time"]) + " " + r["time_unit"],
                         f"{100 * spread:.1f} %", counters])
    print_table(["benchmark", "cpu, median", "clock, median", "cv of cpu", "counters"], rows)


def print_csv(path):
    with open(path, newline="") as file:
        head, *rows = csv.reader(file)
    print_table(head, rows)


if len(sys.argv) != 2:
    sys.exit(__doc__)
(print_json if sys.argv[1].endswith(".json") else print_csv)(sys.argv[1])
