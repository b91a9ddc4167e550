"""The pictures of docs/motions.md: what certifying a motion means, and how many checks it takes."""
import math

from measurements import panels, save

# A bar that is hinged at the origin and 1 m long turns past a post.
POST = (1.02, 0.35)
FROM, TO = math.radians(-35.0), math.radians(55.0)


def distance_to_post(angle):
    x, y = POST
    along = x * math.cos(angle) + y * math.sin(angle)
    across = -x * math.sin(angle) + y * math.cos(angle)
    return math.hypot(max(0.0, along - 1.0, -along), across)


def certify(distance, kept=0.02):
    """(fraction, distance there, certified from, certified to): the middle of what is open first. No point of the bar
    moves by more than its angle times 1 m."""
    speed = TO - FROM
    covers, gaps = [], [(0.0, 1.0)]
    while gaps and len(covers) < 40:
        begin, end = gaps.pop(0)
        at = 0.5 * (begin + end)
        d = distance(FROM + at * speed)
        way = (1.0 - kept) * d / speed
        covers.append((at, d, at - way, at + way))
        if at - way > begin:
            gaps.append((begin, at - way))
        if at + way < end:
            gaps.append((at + way, end))
    return covers


def draw_idea():
    figure, (scene, chart) = panels(1, 2, figsize=(12, 5), gridspec_kw={"width_ratios": [1, 1.5]})
    covers = certify(distance_to_post)
    colours = ["tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown", "tab:olive", "tab:cyan"]

    arc = [FROM + (TO - FROM) * i / 100.0 for i in range(101)]
    scene.plot([math.cos(a) for a in arc], [math.sin(a) for a in arc], color="lightgrey", linewidth=1)
    for angle, style in ((FROM, "--"), (TO, "--")):
        scene.plot([0, math.cos(angle)], [0, math.sin(angle)], color="grey", linestyle=style, linewidth=2)
    for number, (at, d, begin, end) in enumerate(covers):
        colour = colours[number % len(colours)]
        angle = FROM + at * (TO - FROM)
        scene.plot([0, math.cos(angle)], [0, math.sin(angle)], color=colour, linewidth=3)
        swept = [FROM + (TO - FROM) * (max(begin, 0.0) + (min(end, 1.0) - max(begin, 0.0)) * i / 30.0)
                 for i in range(31)]
        scene.fill([0] + [math.cos(a) for a in swept], [0] + [math.sin(a) for a in swept], color=colour, alpha=0.12)
        scene.text(0.75 * math.cos(angle), 0.75 * math.sin(angle), str(number + 1), color=colour, ha="center",
                   va="center", bbox={"boxstyle": "circle", "facecolor": "white", "edgecolor": colour})
    scene.plot(*POST, marker="o", color="black", markersize=9)
    scene.annotate("post", POST, xytext=(10, -4), textcoords="offset points")
    scene.plot(0, 0, marker="o", color="grey")
    scene.set_title("A link turns past a post: from each configuration\nthe sector that is certain to be free",
                    fontsize=10)
    scene.set_aspect("equal")
    scene.set_xlim(-0.1, 1.35)
    scene.axis("off")

    fractions = [i / 400.0 for i in range(401)]
    speed = TO - FROM
    chart.plot(fractions, [distance_to_post(FROM + f * speed) for f in fractions], color="black", linewidth=1.2,
               label="distance of link and post")
    for number, (at, d, begin, end) in enumerate(covers):
        colour = colours[number % len(colours)]
        low, high = max(begin, 0.0), min(end, 1.0)
        chart.fill_between([low, at, high], [d - speed * (at - low), d, d - speed * (high - at)], color=colour,
                           alpha=0.25, linewidth=0)
        chart.plot([low, at, high], [d - speed * (at - low), d, d - speed * (high - at)], color=colour)
        chart.plot(at, d, marker="o", color=colour)
        chart.annotate(str(number + 1), (at, d), xytext=(4, 5), textcoords="offset points", color=colour)
    chart.set_xlim(0, 1)
    chart.set_ylim(0, None)
    chart.set_xlabel("fraction of the motion")
    chart.set_ylabel("metres")
    chart.set_title("One distance, less what the link can move from there, bounds the distance\n"
                    "beside it: the middle first, then the middle of what is left open", fontsize=10)
    chart.legend(loc="upper right", fontsize=9)
    save(figure, "motions_idea.png")


def draw_checks(lines):
    figure, (looked_at, took) = panels(1, 2, figsize=(12, 4.8))
    binned = [line for line in lines if line["length"] != "all"]
    lengths = list(dict.fromkeys(line["length"] for line in binned))
    places = range(len(lengths))
    for clearance in dict.fromkeys(line["clearance"] for line in binned if line["clearance"] != "all"):
        cells = {line["length"]: line for line in binned if line["clearance"] == clearance}
        shown = [(i, float(cells[length]["checks"])) for i, length in enumerate(lengths)
                 if int(cells[length]["free"]) >= 5]
        if shown:
            looked_at.plot(*zip(*shown), marker="o", label=clearance)
    looked_at.plot(places, [(float(length.split()[0]) + float(length.split()[2])) / 2 / 0.05 for length in lengths],
                   color="grey", linestyle="--", label="a loop at 0.05 rad")
    looked_at.set_yscale("log")
    looked_at.set_ylabel("configurations looked at (median)")
    looked_at.legend(title="smallest distance", fontsize=8)
    for key, name in (("us", "certified"), ("us_coarse", "loop at 0.05 rad"), ("us_fine", "loop at 0.01 rad")):
        cells = {line["length"]: line for line in binned if line["clearance"] == "all"}
        took.plot(places, [float(cells[length][key]) for length in lengths], marker="o", label=name)
    took.set_yscale("log")
    took.set_ylabel("median time of a free motion [µs]")
    took.legend(fontsize=8)
    for panel in (looked_at, took):
        panel.set_xticks(list(places))
        panel.set_xticklabels(lengths)
        panel.set_xlabel("length of the motion: the joint that moves most")
        panel.grid(True, which="major", alpha=0.3)
    save(figure, "motions_checks.png")
