#!/usr/bin/python3
"""Renews the tables of docs/scenes.md and their picture from docs/data/scene_*.csv."""
import sys

sys.dont_write_bytecode = True
from measurements import grouped, panels, renew, rows_of, save, table

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


def draw(rows):
    figure, panel = panels(figsize=(7, 4.5))
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
    save(figure, "scene_cost.png")


if __name__ == "__main__":
    scene_costs = rows_of("scene_cost.csv")
    renew("scenes.md", "cost", cost_table(scene_costs))
    renew("scenes.md", "updates", update_table(rows_of("scene_updates.csv"), rows_of("scene_service.csv")))
    draw(scene_costs)
