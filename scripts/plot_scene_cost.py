#!/usr/bin/python3
"""Renews the tables of scenes.md and their picture from data/scene_*.csv, all in the folder given."""
import csv
import os
import sys

sys.dont_write_bytecode = True
from measured_on import renew


def rows_of(folder, name):
    with open(os.path.join(folder, name), newline="") as table:
        return list(csv.DictReader(table))


def grouped(number):
    return "{:,}".format(int(number))


def table(heads, rows):
    return "\n".join("| %s |" % " | ".join(row) for row in [heads, ["---"] * len(heads)] + rows)


WORLDS = {"none": "none", "far": "out of reach", "near": "near, never reached"}


def cost_table(rows):
    """What the page shows; the rest is in the CSV file."""
    heads = ["modelled of pr2", "switched off", "static boxes", "allowed pairs", "memory MB", "narrow phase µs", "cycle µs"]
    lines = []
    for row in rows:
        if row["robot"] == "arms" or row["nb_boxes"] in ("10", "1000") or (row["robot"] != "whole" and row["switched_off"] != "SRDF"):
            continue
        boxes = "–" if row["world"] == "none" else "%s %s" % (grouped(row["nb_boxes"]), WORLDS[row["world"]])
        lines.append([row["robot"], row["switched_off"], boxes, grouped(row["nb_allowed_pairs"]),
                      "%.1f" % (float(row["heap_bytes"]) / 1e6)] +
                     ["%.1f" % float(row[key]) for key in ("narrow_us", "total_us")])
    return table(heads, lines)


def update_table(in_process, service):
    heads = ["objects", "scene rebuilt, in process, ms", "its first cycle, ms", "`update_scene`, one box added, ms",
             "`update_scene`, all of them at once, ms"]
    by_count = {row["nb_objects"]: row for row in service}
    lines = []
    for row in in_process:
        other = by_count[row["nb_objects"]]
        times = (row["build_ms"], row["first_cycle_ms"], other["update_ms"], other["fill_ms"])
        lines.append([grouped(row["nb_objects"])] + ["%.3g" % float(time) for time in times])
    return table(heads, lines)


def draw(rows, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, panel = pyplot.subplots(figsize=(7, 4.5))
    for world, marker, color in (("far", "o", "tab:blue"), ("near", "s", "tab:orange")):
        line = [row for row in rows if row["world"] == world]
        counts = [int(row["nb_boxes"]) for row in line]
        panel.semilogx(counts, [float(row["total_us"]) for row in line], marker=marker, color=color,
                       label="cycle, boxes " + WORLDS[world])
        panel.semilogx(counts, [float(row["sweep_us"]) for row in line], marker=marker, color=color,
                       linestyle=":", label="of that the sweep")
    panel.set_ylim(bottom=0)
    panel.set_xlabel("static boxes")
    panel.set_ylabel("median time [µs]")
    panel.grid(True, which="major", alpha=0.3)
    panel.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def main(folder):
    data = os.path.join(folder, "data")
    rows = rows_of(data, "scene_cost.csv")
    page = os.path.join(folder, "scenes.md")
    renew(page, "cost", cost_table(rows))
    renew(page, "updates", update_table(rows_of(data, "scene_updates.csv"), rows_of(data, "scene_service.csv")))
    draw(rows, os.path.join(folder, "images", "scene_cost.png"))


if __name__ == "__main__":
    main(sys.argv[1])
