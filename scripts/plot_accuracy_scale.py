#!/usr/bin/env python3
"""Plots what accuracy_scale measured: plot_accuracy_scale.py IN.csv OUT.png"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

AXES = (
    ("size", "size of the bodies [m]"),
    ("offset", "offset of 0.2 m bodies from the origin [m]"),
)


def read(path):
    lines = {}
    with open(path, newline="") as table:
        for row in csv.DictReader(table):
            key = (row["varied"], row["first"] + "-" + row["second"])
            point = (float(row["value"]), float(row["worst_relative_error"]))
            lines.setdefault(key, []).append(point)
    return lines


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    lines = read(sys.argv[1])
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.5), sharey=True)
    markers = "osv^Dx"
    for panel, (varied, label) in zip(panels, AXES):
        for i, (pair, points) in enumerate((k[1], v) for k, v in lines.items() if k[0] == varied):
            x, y = zip(*points)
            y = [max(value, 1e-17) for value in y]
            panel.loglog(x, y, marker=markers[i % len(markers)], markersize=4, label=pair)
        panel.set_xlabel(label)
        panel.grid(True, which="major", alpha=0.3)
    x = [1.0, 1e8]
    panels[1].loglog(x, [2.2e-16 * value / 0.2 for value in x], "k--", label="last place of a pose")
    panels[0].set_ylabel("worst error / size")
    panels[0].legend(fontsize=8)
    panels[1].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
