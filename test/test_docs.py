"""What the pages state is tied to what was measured."""
import csv
import os
import re
import shutil
import subprocess

import pytest
import yaml
from conftest import DEMO_BAG, DEMO_ROBOT, PROJECT

# Measured by scripts/measure_trade_off and scripts/benchmark_detector; a number of one must not contradict the other.
PAGES = ["docs/trade_off.md", "docs/performance.md"]


def commit_of(page):
    found = re.findall(r"Measured at commit ([0-9a-f]{10})(\+?) on", part_of(page, "commit"))
    assert len(found) == 1, "%s names %d commits" % (page, len(found))
    assert not found[0][1], "%s was measured with changes that are in no commit" % page
    return found[0][0]


def test_pages_whose_numbers_are_compared_were_measured_at_one_commit():
    assert len({commit_of(page) for page in PAGES}) == 1


def test_what_the_trade_off_page_says_of_hulls_is_what_its_table_says():
    rows = {}
    with open(os.path.join(PROJECT, "docs/data/trade_off.csv"), newline="") as table:
        for row in csv.DictReader(table):
            rows.setdefault((row["robot"], row["query"]), {})[row["rung"]] = row
    with open(os.path.join(PROJECT, "docs/trade_off.md"), encoding="utf-8") as text:
        page = text.read()
    robots = {key: rungs for key, rungs in rows.items() if key[0] != "demo"}

    def p99(rungs, rung):
        return float(rungs[rung]["p99_us"])
    times = [p99(rungs, "mesh") / p99(rungs, "convex") for rungs in robots.values()]
    said = re.search(r"(\d+) to (\d+) times less than triangles", page)
    assert [round(min(times)), round(max(times))] == [int(n) for n in said.groups()]
    simplified = [(rungs, rung) for rungs in robots.values() for rung in ("convex32", "convex64")]
    saved = [100 * (1 - p99(rungs, rung) / p99(rungs, "convex")) for rungs, rung in simplified]
    errors = [1000 * float(rungs[rung]["error_median"]) for rungs, rung in simplified]
    said = re.search(r"at most (\d+) % off the slowest per cent of the same robots for (\d+) to (\d+) mm", page)
    assert [round(max(saved)), round(min(errors)), round(max(errors))] == [int(n) for n in said.groups()]
    said = re.search(r"pr2 with its world: (\d+) µs", page)
    assert round(float(rows["pr2", "world"]["aabb"]["median_us"])) == int(said.group(1))
    assert "contacts missed: none" in page
    missed = [float(rung["miss_share"]) for rungs in rows.values() for rung in rungs.values()]
    assert missed and max(missed) == 0


def test_the_text_of_the_trade_off_picture_says_what_was_measured():
    rows = data("trade_off.csv")
    for rung, sentence in (("aabb", r"boxes take (\d+) to (\d+) µs"), ("mesh", r"meshes (\d+) to (\d+) µs")):
        shown = {row["robot"]: float(row["median_us"]) for row in rows if row["rung"] == rung and row["query"] == (
            "self" if row["robot"] == "demo" else "world")}
        check_range(sentence, list(shown.values()), "README.md")


def test_geometries_are_called_what_the_parameter_is_called():
    fidelities = re.search(r"geometry that decides: (.*?)\.", read("config/collision_pairs_node.yaml")).group(1)
    named = re.findall(r"^\| ([a-z]+)\d*(?: \d+ mm)? \|", part_of("docs/trade_off.md", "rungs"), re.MULTILINE)
    assert len(named) > 10 and set(named) <= set(re.findall(r"\w+", fidelities))


def test_the_table_of_planners_is_what_its_script_makes_of_the_data(tmp_path):
    for name in ("scripts/measure_planning", "scripts/measurements.py", "docs/planners.md", "docs/data/planning.csv"):
        os.makedirs(os.path.dirname(tmp_path / name), exist_ok=True)
        shutil.copy(os.path.join(PROJECT, name), tmp_path / name)
    subprocess.run([tmp_path / "scripts/measure_planning", "--draw-only"], check=True, timeout=60)
    assert (tmp_path / "docs/planners.md").read_text(encoding="utf-8") == read("docs/planners.md")


def read(*path):
    with open(os.path.join(PROJECT, *path), encoding="utf-8") as text:
        return text.read()


def pages():
    return ["README.md"] + sorted("docs/" + name for name in os.listdir(os.path.join(PROJECT, "docs")) if name.endswith(".md"))


def anchors_of(page):
    """As GitHub makes them of headings."""
    headings = re.findall(r"^#+ (.+)$", page, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", pages())
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", read(page)):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        path = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        assert os.path.exists(os.path.join(PROJECT, path)), target
        assert not anchor or anchor in anchors_of(read(path)), target


def test_every_picture_is_shown_on_a_page():
    texts = "".join(map(read, pages()))
    assert [name for name in os.listdir(os.path.join(PROJECT, "docs/images")) if "images/" + name not in texts] == []


def test_the_index_lists_every_page():
    listed = re.findall(r"^\| \[(\w+\.md)\]", read("docs/README.md"), re.MULTILINE)
    assert sorted(listed) == sorted(os.path.basename(page) for page in pages() if os.path.basename(page) != "README.md")


def test_the_readme_is_read_in_a_few_minutes():
    assert len(read("README.md").split()) <= 900


def test_the_readme_answers_on_its_first_two_screens_what_a_newcomer_asks():
    two_screens = "\n".join(read("README.md").splitlines()[:60])
    for answer in ("which links of a ROS 1 robot touch", "scripts/demo --headless", "| `UNKNOWN` | anything else", "2 to 4 µs",
                   "none was wrong", "not safety-rated"):
        assert answer in two_screens, answer


def test_what_the_readme_calls_by_name_is_there():
    recorded, page = read("docs/data/public_names.txt"), read("README.md")
    for name in set(re.findall(r"`~(\w+)`", page)):
        assert re.search(r"^(topic|service|parameter) ~%s\b" % name, recorded, re.MULTILINE), name
    for argument in set(re.findall(r" (\w+):=", page)):
        assert "argument collision_pairs.launch/%s:=" % argument in recorded, argument
    for option in set(re.findall(r"`(--\w+)`", page)) - {"--clock"}:  # rosbag's
        assert re.search(r"^  %s\)|^    %s\)" % (option, option), read("scripts/demo"), re.MULTILINE), option
    rate, near = (re.search(r"^%s: ([\d.]+)" % name, read("config/collision_pairs_node.yaml"), re.MULTILINE).group(1)
                  for name in ("rate", "alarm_distance"))
    assert "%g times a second" % float(rate) in page and "within %s m (`~alarm_distance`)" % near in " ".join(page.split())


def test_the_readme_shows_what_the_demo_prints(check_bag):
    """The demo's recording is of the same motion."""
    lines = re.findall(r"^ {3}\d+\.\d\d s  (\S+)  \((\d+) boxes, \d+ pairs investigated(?:, closest ([+-]\d+\.\d) mm)?\)$",
                       read("README.md"), re.MULTILINE)
    near = re.search(r"^alarm_distance: ([\d.]+)", read("config/demo/node.yaml"), re.MULTILINE).group(1)
    assert "Investigated: pairs whose boxes are within %s m." % near in read("README.md")
    rows, _ = check_bag(DEMO_BAG, *DEMO_ROBOT)
    touching = {pair for row in rows if row["in_collision"] == "1" for pair in row["pairs"].split(";")}
    assert len(lines) == 5 and {boxes for _, boxes, _ in lines} == {"22"}
    for pair, _, closest in lines:
        assert pair == "free" and not closest.startswith("-") or pair in touching and closest.startswith("-"), pair
    assert '"%7.2f s  %s  (%d boxes, %d pairs investigated%s)"' in read("scripts/print_collision_pairs")


# Standard terms instead: finer, coarser, OBB, repair, attached to.
@pytest.mark.parametrize("word", (r"dear(er|est)", r"turned box", r"mend(s|ed|ing)?", r"hangs? on"))
def test_pages_and_messages_use_standard_terms(word):
    texts = pages() + ["config/collision_pairs_node.yaml", "cfg/CollisionPairs.cfg"]
    texts += [os.path.join(folder, name) for folder in ("msg", "srv") for name in os.listdir(os.path.join(PROJECT, folder))]
    found = [text for text in texts if re.search(r"\b%s\b" % word, read(text), re.IGNORECASE)]
    assert not found


def part_of(page, name):
    """What a script renews."""
    return re.search(r"<!-- %s: begin -->(.*?)<!-- %s: end -->" % (name, name), read(page), re.DOTALL).group(1)


def data(name, **wanted):
    """Rows of a table that a script measured."""
    with open(os.path.join(PROJECT, "docs", "data", name), newline="") as table:
        found = [row for row in csv.DictReader(table) if all(row[key] == value for key, value in wanted.items())]
    assert found, name
    return found


def check_range(sentence, values, page):
    """The two numbers in `sentence`, a pattern, are the least and the largest of the values, as far as they are written out."""
    said = re.search(sentence, read(page))
    assert said, sentence
    for number, value in zip(said.groups(), (min(values), max(values))):
        digits = len(number.partition(".")[2])
        assert float(number) == round(value, digits), "%s: %s, measured: %g to %g" % (page, said.group(), min(values), max(values))


def check_least(sentence, values, page="docs/performance.md"):
    said = re.search(sentence, read(page))
    assert said, sentence
    digits = len(said.group(1).partition(".")[2])
    assert float(said.group(1)) == round(min(values), digits), "%s: %s, measured: at least %g" % (page, said.group(), min(values))


def test_what_the_performance_page_says_of_many_states_was_measured():
    check_least(r"\| ([\d.]+) times as fast \| a loop over the exact check \| the least .*, with AVX2; no verdict differs",
                [float(row["ratio"]) for row in data("verdicts.csv", kernel="avx2")])
    assert {row["differ"] for row in data("verdicts.csv")} == {"0"}


def test_what_the_performance_page_says_of_motions_was_measured():
    rows = data("motions.csv", length="all")
    ratios = [float(row["ratio"]) for row in rows if row["robot"] != "all"]
    said = re.search(r"([\d.]+) of the time \| a loop with steps of 0.05 rad, which misses 1 of (\d+) contacts \| the most of four", read("docs/performance.md"))
    every, = (row for row in rows if row["robot"] == "all")
    assert float(said.group(1)) == round(max(ratios), 1)
    assert int(said.group(2)) == round(int(every["contacts"]) / int(every["coarse_misses"]), -1)


def test_what_the_performance_page_says_of_the_broad_phase_was_measured():
    def ratios(instruction_set, chosen):
        times = {(row["scene"], int(row["boxes"]), row["peer"]): float(row["us"])
                 for row in data("broad_phase.csv", instruction_set=instruction_set)}
        return [us / times[scene, boxes, "SweepAndPrune"] for (scene, boxes, peer), us in times.items()
                if peer == "FclDynamicAabbTree" and chosen(scene, boxes)]
    check_least(r"\| (\d+) times as fast \| FCL's tree \| the least for uniform boxes, up to 100,000, AVX2 or wider; in no scene",
                ratios("default", lambda scene, boxes: scene.startswith("uniform") and boxes <= 100000) +
                ratios("avx2", lambda scene, boxes: True))
    assert min(ratios("default", lambda scene, boxes: True)) > 1
    assert len({row["scene"] for row in data("broad_phase.csv")}) == 8


def test_what_the_performance_page_says_of_few_boxes_was_measured():
    rows = [row for row in data("few_boxes.csv", kernel="avx2") if not row["scene"].startswith("uniform")]
    check_range(r"takes ([\d.]+) to ([\d.]+) of its time", [float(row["each_ns"]) / float(row["ranks_ns"]) for row in rows],
                "docs/performance.md")


def test_what_the_pages_say_of_whole_checks_was_measured():
    def ratios(figure, *queries):
        return [float(row[figure + "_ratio"]) for row in data("detector.csv") if row["query"] in queries]
    assert {row["instruction_set"] for row in data("detector.csv")} == {"default", "avx2"}
    check_least(r"\(`verdict_only`\) \| (\d+) times as fast \|", ratios("median", "self", "world"))
    check_least(r"distance to a world \| (\d+) times as fast \|", ratios("median", "world_distance"))
    check_least(r"slowest percent of all these and of contacts \| (\d+) times as fast \|",
                ratios("p99", "self_contacts", "self_distance", "world_distance", "self", "world"))
    check_least(r"yes or no \| .* \| at least (\d+) times as long: FCL, called as MoveIt does", ratios("median", "world"), "README.md")
    check_least(r"distance to the world \| .* \| at least (\d+) times as long: the same", ratios("median", "world_distance"), "README.md")
    for sentence, query in ((r"yes or no \| (\d+) to (\d+) µs in the median", "world"),
                            (r"a verdict takes (\d+) to (\d+) µs", "world"),
                            (r"distance to the world \| (\d+) to (\d+) µs", "world_distance")):
        check_range(sentence, [float(row["median_us"]) for row in data("detector.csv", query=query, instruction_set="default")], "README.md")


def test_what_the_trade_off_page_says_of_whole_checks_with_fcl_was_measured():
    times = {(row["method"], row["robot"], row["query"]): row for row in data("native_and_fcl_robots.csv")}

    def ratios(figure, of):
        return [float(row[figure]) / float(times["native", robot, query][figure])
                for (method, robot, query), row in times.items() if method == "fcl" and of(query)]
    check_range(r"takes ([\d.]+) to ([\d.]+) times as long with `fcl` for yes or no",
                ratios("median_us", lambda query: "distance" not in query), "docs/trade_off.md")
    check_range(r"and (\d+) to (\d+) times for a distance", ratios("median_us", lambda query: "distance" in query), "docs/trade_off.md")
    check_range(r"the slowest per cent ([\d.]+) to (\d+) times", ratios("p99_us", lambda query: True), "docs/trade_off.md")


def test_the_request_of_the_page_that_attaches_an_object_has_the_fields_of_the_message():
    change, = yaml.safe_load(re.search(r"'(\{changes: .*\})'", read("docs/scenes.md")).group(1))["changes"]
    constants = dict(re.findall(r"^uint8 (\w+)=(\d+)", read("msg/SceneChange.msg"), re.MULTILINE))
    assert change["operation"] == int(constants["ATTACH"])
    assert set(change["object"]) <= set(re.findall(r"^[\w/\[\]]+ +(\w+)", read("msg/SceneObject.msg"), re.MULTILINE))


def test_what_the_page_says_of_pairs_that_only_shipped_srdfs_disable_was_measured():
    rows = data("generated_srdf_differences.csv")
    said = re.search(r"Each of the (\d+) pairs that only the shipped file disables.*?; (\d+) of these contacts", read("docs/scenes.md"), re.DOTALL)
    assert [int(number) for number in said.groups()] == [len(rows), sum(row["found_by_search"] == "1" for row in rows)]
    assert all(row["contact_state"] for row in rows)


def test_what_the_readme_and_the_page_say_of_accuracy_was_measured():
    errors = {(row["first"], row["second"]): float(row["worst"]) for row in data("accuracy.csv", quantity="distance")}
    said = re.search(r"error of a distance \| at most (\S+) m \|.*shapes of 20 cm", read("README.md"))
    worst = max(errors, key=errors.get)
    assert worst == ("convex", "convex") and float(said.group(1)) == float("%.0e" % errors[worst])
    rows = data("accuracy_ratio.csv")
    assert {row["wrong"] for row in rows} == {row["contradictions"] for row in rows} == {"0"}
    assert max(float(row["worst_over_goal"]) for row in rows) <= 1
    page = read("docs/accuracy.md")
    assert "Of {:,} pairs no verdict is wrong and {} depths are bounds".format(
        *(sum(int(row[key]) for row in rows) for key in ("poses", "bound"))) in page
    assert "Distances: at most %.0e m, for two hulls" % errors[worst] in page


def faults():
    """{(section, what fails)} of the page."""
    section, found = None, []
    for line in read("docs/faults.md").splitlines():
        section = line[4:] if line.startswith("### ") else section
        if section and line.startswith("| ") and not line.startswith("| what fails |"):
            cells = line.strip("| ").split(" | ")
            assert len(cells) == 3, line
            found.append((section, cells[0]))
    assert len(found) == len(set(found)) > 30
    return set(found)


def test_each_fault_has_a_test_that_exists():
    folders = [os.path.join(PROJECT, "test", folder) for folder in ("", "ros")]
    sources = "".join(read(folder, name) for folder in folders for name in os.listdir(folder) if name.startswith("test_"))
    exist = set(re.findall(r"^ *def (test_\w+)\(", sources, re.MULTILINE))
    exist |= {".".join(names) for names in re.findall(r"^TEST(?:_[FP])?\((\w+),\s*(\w+)\)", sources, re.MULTILINE)}
    rows = data("fault_tests.csv")
    assert {row["test"] for row in rows} <= exist
    assert {(row["section"], row["what fails"]) for row in rows} == faults()


@pytest.mark.parametrize("page", pages())
def test_the_rostests_that_a_page_names_exist(page):
    exist = set(re.findall(r"collision_pairs_rostest\((\w+)\)", read("cmake", "tests.cmake")))
    assert set(re.findall(r"`rostest_(\w+)`", read(page))) <= exist


def test_the_watchdogs_of_the_page_wait_equally_long_and_longer_than_a_period_of_the_node():
    page, rate = read("docs/faults.md"), float(re.search(r"^rate: ([\d.]+)", read("config/collision_pairs_node.yaml"), re.MULTILINE).group(1))
    lock = yaml.safe_load(re.search(r"```yaml\n(.*?)```", page, re.DOTALL).group(1))[0]
    call = re.search(r'Watchdog\("(.*)", timeout=([\d.]+)\)', page)
    assert call.groups() == (lock["topic"], str(lock["timeout"])) and lock["timeout"] > 3 / rate
    assert "timeout=%s)" % lock["timeout"] in read("src/python/collision_pairs/watchdog.py")


CONSTANTS = [  # what a page says, the file, and what must stand there
    ("limiter", "longer than 20 ms", "src/ros/limiter/velocity_limiter.cpp", "TIME_TO_DECIDE = 0.02;"),
    ("limiter", "prepared for longer than 10 ms", "src/ros/limiter/velocity_limiter.cpp", "TIME_TO_PREPARE = 0.01,"),
    ("limiter", "the search stops after 15 ms", "src/ros/limiter/velocity_limiter.cpp", "TIME_TO_SEARCH = 0.015;"),
    ("limiter", "nearer than 0.02 mm", "src/core/limiter/limiter_law.cpp", "CONTACT = 2e-5;"),
    ("limiter", "by more than 0.1 mm", "src/core/limiter/certified_surroundings.cpp", "DEEPER = 1e-4;"),
    ("limiter", "at five places", "src/core/limiter/certified_surroundings.cpp", "PLACES = 4;"),
    ("limiter", "up to five certificates", "src/core/limiter/limiter_law.cpp", "MOST_CERTIFICATES = 5;"),
    ("limiter", "its stop distance plus 2 mm", "src/core/limiter/limiter_law.cpp", "ROOM_TO_RETREAT = 0.002;"),
    ("limiter", "once 2 mm more are certified", "src/core/limiter/limiter_law.cpp", "ROOM_TO_GO_ON = 0.002;"),
    ("limiter", "more than 26 degrees", "src/core/limiter/limiter_law.cpp", "SAME_DIRECTION = 0.9;"),
    ("limiter", "of 200 random states", "src/core/limiter/certified_surroundings.cpp", "STATES = 200;"),
    ("limiter", "down to a 64th of it", "src/core/limiter/limiter_law.cpp", "RETREATS[] = {1.0, 0.5, 0.125, 1.0 / 64.0};"),
    ("limiter", "keep half of it,", "src/core/limiter/limiter_law.cpp", "GIVEN_AWAY = 0.5;"),
    ("limiter", "when the decision is made: stop. At most 1. ", "src/ros/limiter/limiter_parameters.cpp", "OLDEST_JOINT_STATE = 1.0;"),
    ("motions", "After 300,000 configurations", "src/core/motion/motion_check.cpp", "MOST_CHECKS = 300'000;"),
    ("motions", "a million open parts", "src/core/motion/motion_check.cpp", "MOST_OPEN_PAIRS = 1'000'000;"),
    ("many_states", "once 30,000 verdicts", "include/collision_pairs/batch_check.h", "STATES_WORTH_A_STAGE = 30000;"),
    ("moveit", "More than eight attached bodies", "src/planners/moveit/moveit_scene.cpp", "NB_ANCHORS = 8;"),
    ("scenes", "in the first 1,024 states", "src/core/pair_statistics/pair_statistics.h", "MEASURED_STATES = 1024;"),
    ("clouds", "something within 30 cm of its place", "src/core/clouds/occluded_obstacles.h", "FOUND_AGAIN = 0.3;"),
    ("clouds", "up to 100,000 voxels", "src/messages/scene_markers.h", "MOST_DRAWN_VOXELS = 100000;"),
    ("faults", "| 2 s, or three periods |", "src/ros/node/report_publisher.cpp", "SHORTEST_LIFE = 2.0;"),
    ("faults", "more than 10000 frames", "src/transforms/transform_gate.cpp", "MOST_NAMES = 10000;"),
    ("faults", "more than 1 % of its surface", "src/core/scene/collision_scene.cpp", "TOLD_ABOVE = 0.01;"),
    ("faults", "or use up memory (it reads COLLADA and glTF) | 30 s |", "src/io/meshes/read_mesh_file.cpp", "TIME_LIMIT = 60;"),
    ("node", "(beyond 0.1 mm and 0.1 mrad)", "src/transforms/transform_gate.h", "SAME_PLACE = 1e-4;"),
    ("node", "more than a tenth of the cycles", "src/ros/node/node_health.cpp", "FREQUENT = 0.1;"),
]


@pytest.mark.parametrize("page, sentence, source, constant", CONSTANTS)
def test_what_a_page_says_of_a_constant_is_what_the_code_has(page, sentence, source, constant):
    assert sentence in " ".join(read("docs/%s.md" % page).split())
    assert constant in read(source)
