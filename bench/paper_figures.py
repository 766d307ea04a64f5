#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the figures 4 and 5 of the paper from the CSV of paper_figures.

usage: paper_figures.py FIGURES.csv FOLDER      writes FOLDER/figure4.png and FOLDER/figure5.png
Needs the Debian package python3-matplotlib.
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"error": "tab:blue", "roi": "tab:orange"}


def lines_of(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for key in row:
            if key not in ("terrain", "cost"):
                row[key] = float(row[key])
    return [row for row in rows if row["vertices"] <= 50000]


def draw(axes, rows, cost, key, style, label):
    random = [r for r in rows if r["terrain"] == "random" and r["cost"] == cost]
    axes.plot([r["vertices"] for r in random], [r[key] for r in random], style, color=COLOURS[cost],
              marker=".", linewidth=1.2, label=label)
    real = [r for r in rows if r["terrain"] == "real" and r["cost"] == cost]
    axes.plot([r["vertices"] for r in real], [r[key] for r in real], "x", color=COLOURS[cost], markersize=7)


def draw_bound(axes, value, text):
    axes.axhline(value, color="black", linewidth=0.9, linestyle=(0, (6, 3)))
    axes.annotate(text, (0.985, value), xytext=(0, 2), xycoords=("axes fraction", "data"),
                  textcoords="offset points", ha="right", va="bottom", fontsize=8)


def finish(axes, title, ylabel):
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("vertices of the TIN (crosses: real TINs)")
    axes.set_ylabel(ylabel)
    axes.set_xlim(0, 52000)
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, ncol=2, loc="upper center", bbox_to_anchor=(0.5, -0.17), frameon=False)


def figure4(rows, path):
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.7))
    for axes, share, name in ((panels[0], 25, "1/25"), (panels[1], 4, "1/4")):
        for cost in ("error", "roi"):
            draw(axes, rows, cost, f"ratio{share}_mean", "-", f"{cost} cost, mean")
            draw(axes, rows, cost, f"ratio{share}_worst", ":", f"{cost} cost, worst of the places")
        draw_bound(axes, 3, "paper: below 3 as the TIN grows")
        finish(axes, f"windows of {name} of the area, 2500 places", "splits retrieved / vertices in the window")
    panels[1].set_ylim(0, 3.4)
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def figure5(rows, path):
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.7))
    titles = ("splits whose own polygon holds the point", "splits retrieved: the mesh stays valid everywhere")
    for axes, key, title in zip(panels, ("polygon", "point"), titles):
        for cost in ("error", "roi"):
            draw(axes, rows, cost, f"{key}_mean", "-", f"{cost} cost, mean")
            draw(axes, rows, cost, f"{key}_worst", ":", f"{cost} cost, worst of the places")
        draw_bound(axes, 70, "paper: never above 70")
        finish(axes, title, "splits a point")
    panels[0].set_ylim(0, 80)
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    rows = lines_of(sys.argv[1])
    figure4(rows, sys.argv[2] + "/figure4.png")
    figure5(rows, sys.argv[2] + "/figure5.png")


main()
