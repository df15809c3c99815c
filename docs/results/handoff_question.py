"""Cheap hand-offs beside dear ones, what the surface follows, and what moves without sunlight.

    python3 docs/results/handoff_question.py run 02=0.1 04=0.5     # builds the bodies, then runs of so many Myr
    python3 docs/results/handoff_question.py run 02 --ways brief collapse-1e-3
    python3 docs/results/handoff_question.py table                 # what they show
    python3 docs/results/handoff_question.py creep 02 04           # the same bodies without sunlight

Bodies start from one settled file each, and from that file with the centres moved by 1e-9 m: the dynamics is chaotic, so what a
way of running changes is judged against what 1e-9 m change. Everything is in out/handoff_question (--out) and is resumed where it is there already. Needs nothing but Python.
"""

import argparse
import concurrent.futures
import csv
import json
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PERTURBATION_M = 1e-9
WAYS = {  # what differs from the scene: place and value
    "full": ("settling.question", "full"),
    "brief": ("settling.question", {"brief": {}}),
    "glance-0.5": ("settling.question", {"brief": {"glance_rotations": 0.5}}),
    "rattle-0": ("evolution.rattle_radius_fraction", 0),
    "rattle-0.25": ("evolution.rattle_radius_fraction", 0.25),
    "collapse-1e-4": ("contact.hard_sphere.collapse_limit", 1e-4),
    "collapse-1e-3": ("contact.hard_sphere.collapse_limit", 1e-3),
}


def yorp(options, *arguments):
    """Asks the program, on one thread; its JSON answer, or the end if it fails."""
    threads = [] if arguments[0] == "classify" else ["--threads", "1"]
    done = subprocess.run([options.yorp, *map(str, arguments), *threads, "--json"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"yorp {' '.join(map(str, arguments))} failed:\n{done.stderr.strip()}")
    return json.loads(done.stdout)


def body(options, name, copy):
    """The settled body of a scene, or its copy 1 with centres moved by 1e-9 m."""
    path = options.out / f"{name}-{copy}.csv"
    if path.exists():
        return path
    if copy == 0:
        yorp(options, "build", options.scenes / f"{name}.json", "--out", path)
        return path
    header, *rows = csv.reader(body(options, name, 0).read_text().splitlines())
    column = header.index("x_m")
    for k, row in enumerate(rows):
        row[column] = repr(float(row[column]) + (-1) ** k * PERTURBATION_M)
    path.write_text("".join(",".join(row) + "\n" for row in [header, *rows]))
    return path


def scene(options, name, way, copy):
    """The scene with that body and in that way."""
    text = json.loads((options.scenes / f"{name}.json").read_text())
    text["body"] = {"file": {"path": body(options, name, copy).name}}
    place, value = WAYS[way]
    *folders, key = place.split(".")
    part = text
    for folder in folders:
        part = part.setdefault(folder, {})
    part[key] = value
    path = options.out / f"{name}-{way}-{copy}.json"
    path.write_text(json.dumps(text, indent=2))
    return path


def run(options):
    """All variants of all bodies, as many at a time as there are jobs."""
    goals = dict(map(goal, options.names))
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(lambda name: body(options, name, 1), goals))
        tasks = [(name, way, copy) for name in goals for way in options.ways for copy in (0, 1)]
        list(pool.map(lambda task: advance(options, goals[task[0]], *task), tasks))


def goal(word):
    """Name and Myr of NAME or NAME=MYR."""
    name, _, myr = word.partition("=")
    try:
        return name, float(myr or 0.1)
    except ValueError:
        sys.exit(f"{word}: NAME or NAME=MYR with a number of Myr is expected")


def advance(options, myr, name, way, copy):
    directory = options.out / f"{name}-{way}-{copy}"
    resume = ["--resume"] if (directory / "run.sqlite").exists() else []
    yorp(options, "run", scene(options, name, way, copy), "--out", directory, "--until-myr", myr, *resume)


def table(options):
    """Movements by body and way."""
    print("| body | way | Myr | hand-offs | movements | a Myr | spheres: median, mean | all | inner half | outer tenth | rate of the spin changes by, % | CPU s a check | a movement |")
    print("|" + " --- |" * 13)
    for path in sorted(options.out.glob("*-0.csv")):
        name = path.stem[:-2]
        for way in WAYS:
            for copy in (0, 1):
                directory = options.out / f"{name}-{way}-{copy}"
                if (directory / "run.sqlite").exists():
                    label = way.replace("-", " of ", 1) + ", perturbed" * copy
                    print(row(name, label, yorp(options, "classify", directory)))


def row(name, label, found):
    movements, cost, spheres = found["movements"], found["cost"], found["movements"]["spheres"]
    number = lambda value, form: "-" if value is None else format(value, form)
    cells = [
        name, label, f"{found['t_myr']:.2f}", cost["checks"] + cost["movements"], movements["count"],
        f"{movements['count'] / found['t_myr']:.0f}" if found["t_myr"] > 0 else "-",
        f"{number(spheres['median'], '.0f')}, {number(spheres['mean'], '.0f')}", movements["spheres_moved"],
        number(movements["inner_half"], ".2f"), number(movements["outer_tenth"], ".2f"),
        number(change_of_rate(found["walk"]["intervals"]), ".0f"),
        number(cost["cpu_seconds_per_check"], ".1f"), number(cost["cpu_seconds_per_movement"], ".1f"),
    ]  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |"


def change_of_rate(intervals):
    """What a movement changes the rate of the spin by, relative to before, percent: median; None without movements."""
    rates = [(i["spin_rev_day"][1] - i["spin_rev_day"][0]) / i["length_myr"] for i in intervals if i["length_myr"] > 0]
    changes = [100 * abs(after / before - 1) for before, after in zip(rates, rates[1:]) if before]
    return statistics.median(changes) if changes else None


def creep(options):
    """Spheres that move in each of four successive stretches of five rotations without sunlight, the spin left alone."""
    print("| body | moved in each five rotations | the same, perturbed |")
    print("| --- | --- | --- |")
    for name in options.names:
        cells = []
        for copy in (0, 1):
            here, moved = body(options, name, copy), []
            for stretch in range(4):
                there = options.out / f"{name}-{copy}-alone-{stretch}.csv"
                moved.append(yorp(options, "relax", here, "--rotations", 5, "--out", there)["moved_spheres"])
                here = there
            cells.append(", ".join(map(str, moved)))
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=["run", "table", "creep"])
    parser.add_argument("names", nargs="*", help="scenes: NAME, or NAME=MYR")
    parser.add_argument("--ways", nargs="*", choices=WAYS, default=list(WAYS), help="ways to run them")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "handoff_question")
    parser.add_argument("--scenes", type=pathlib.Path, default=ROOT / "scenarios" / "cotto_figueroa_2015")
    parser.add_argument("--yorp", type=pathlib.Path, default=ROOT / "target" / "release" / "yorp")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    {"run": run, "table": table, "creep": creep}[options.verb](options)


main()
