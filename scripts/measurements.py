"""What the scripts that measure share: programs, tables in docs/data, tables and pictures in pages."""
import argparse
import csv
import json
import os
import re
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
DATA = os.path.join(ROOT, "docs", "data")


def parser_of(doc, build="build/benchmark"):
    """Of a script with this docstring."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, build), help="where to build (default %(default)s)")
    parser.add_argument("--draw-only", action="store_true", help="from docs/data as it is")
    return parser


def built(directory, *targets):
    """Builds these targets; returns the folder of the programs."""
    for command in (["-S", ROOT, "-B", directory, "-DCMAKE_BUILD_TYPE=Release", "-DCOLLISION_PAIRS_BENCHMARKS=ON"],
                    ["--build", directory, "--target", *targets, "-j2"]):
        subprocess.run(["cmake", *command], check=True, stdout=subprocess.DEVNULL)
    return os.path.join(directory, "devel", "lib", "collision_pairs")


def output_of(folder, program, *arguments, **environment):
    return subprocess.run([os.path.join(folder, program), *map(str, arguments)], check=True, stdout=subprocess.PIPE,
                          text=True, env=dict(os.environ, **environment)).stdout


def benchmark(folder, program, pattern, *options, **environment):
    """What a program of Google Benchmark says of its benchmarks that match."""
    text = output_of(folder, program, "--benchmark_filter=" + pattern, "--benchmark_format=json", *options, **environment)
    return json.loads(text)["benchmarks"]


def rows_in(text):
    return list(csv.DictReader(text.splitlines()))


def rows_of(name):
    """Of a table in docs/data."""
    with open(os.path.join(DATA, name), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def keep(name, rows, columns=None):
    """As a table in docs/data."""
    with open(os.path.join(DATA, name), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns or list(rows[0]), extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def grouped(number):
    return "{:,}".format(int(number))


def table(heads, rows):
    lines = ["| %s |" % " | ".join(row) for row in [heads] + rows]
    return "\n".join(lines[:1] + ["|" + "---|" * len(heads)] + lines[1:])


def commit():
    """Of what is built: with a "+" where sources differ from it."""
    git = ["git", "-C", ROOT]
    name = subprocess.run(git + ["rev-parse", "--short=10", "HEAD"], check=True, stdout=subprocess.PIPE, text=True).stdout
    changed = subprocess.run(git + ["status", "--porcelain", "--", "src", "include", "benchmark"], check=True,
                             stdout=subprocess.PIPE, text=True).stdout
    return name.strip() + ("+" if changed else "")


def measured_on():
    with open("/proc/cpuinfo") as info:
        text = info.read()
    model = re.search(r"model name\s*: (.*)", text).group(1)
    flags = re.search(r"flags\s*: (.*)", text).group(1).split()
    kernels = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "SSE2"
    return "Measured at commit %s on one core of: %s, %s.\n" % (commit(), model, kernels)


def renew(page, name, text):
    """Puts `text` between the marks <!-- name: begin --> and <!-- name: end --> of the page in docs."""
    path = os.path.join(ROOT, "docs", page)
    with open(path, encoding="utf-8") as file:
        old = file.read()
    begin, end = "<!-- %s: begin -->\n" % name, "<!-- %s: end -->" % name
    new = old[:old.index(begin) + len(begin)] + text + "\n" + old[old.index(end):]
    with open(path, "w", encoding="utf-8") as file:
        file.write(new)


def panels(*counts, **options):
    """A figure and its panels, as pyplot.subplots() makes them, without a screen."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    return pyplot.subplots(*counts, **options)


def save(figure, name, dpi=100, **layout):
    """As a picture in docs/images."""
    figure.tight_layout(**layout)
    figure.savefig(os.path.join(ROOT, "docs", "images", name), dpi=dpi)
