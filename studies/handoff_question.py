"""Cheap hand-offs beside dear ones, and what moves without sunlight.

    python3 studies/handoff_question.py run 04=0.2 07=0.15 --ways full brief   # builds the bodies, then runs of so many Myr
    python3 studies/handoff_question.py table                 # run by run
    python3 studies/handoff_question.py compare               # each way against the full question
    python3 studies/handoff_question.py creep 04 04-full-0    # bodies, and the last states of runs, without sunlight

Bodies start from one settled file each, and from that file with the centres moved by 1e-9 m in other patterns: the dynamics is
chaotic, so what a way of running changes is judged against what 1e-9 m change. Everything is in out/handoff_question (--out) and
is resumed where it is there already. Needs nothing but Python.
"""

import argparse
import concurrent.futures
import contextlib
import csv
import json
import math
import pathlib
import sqlite3
import statistics
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PERTURBATION_M = 1e-9
STRETCHES = 16
FEWEST_SPHERES = 100
WAYS = {  # what the scene's settling has besides
    "full": {"question": "full"},
    "brief": {},
    "load-300": {"question": {"brief": {"rotations_per_load": 300}}},
    "glance-0.1": {"question": {"brief": {"rotations_per_load": 0, "glance_rotations": 0.1}}},
    "keep": {"residual_rotation": "keep"},
    "before": {},  # with the program that --before names
}


def yorp(options, *arguments, way=None):
    """Asks the program, on one thread; its JSON answer, or the end if it fails."""
    threads = [] if arguments[0] == "classify" else ["--threads", "1"]
    program = options.before if way == "before" else options.yorp
    done = subprocess.run([program, *map(str, arguments), *threads, "--json"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"yorp {' '.join(map(str, arguments))} failed:\n{done.stderr.strip()}")
    return json.loads(done.stdout)


def body(options, name, copy):
    """The settled body of a scene, or a copy with centres moved by 1e-9 m back and forth, each so many rows."""
    path = options.out / f"{name}-{copy}.csv"
    if path.exists():
        return path
    if copy == 0:
        yorp(options, "build", options.scenes / f"{name}.json", "--out", path)
        return path
    header, *rows = csv.reader(body(options, name, 0).read_text().splitlines())
    column = header.index("x_m")
    for k, row in enumerate(rows):
        row[column] = repr(float(row[column]) + (-1) ** (k // copy) * PERTURBATION_M)
    path.write_text("".join(",".join(row) + "\n" for row in [header, *rows]))
    return path


def scene(options, name, way, copy):
    """The scene with that body and in that way."""
    text = json.loads((options.scenes / f"{name}.json").read_text())
    text["body"] = {"file": {"path": body(options, name, copy).name}}
    text["settling"] = text.get("settling", {}) | WAYS[way]
    path = options.out / f"{name}-{way}-{copy}.json"
    path.write_text(json.dumps(text, indent=2))
    return path


def run(options):
    """All variants of all bodies, as many at a time as there are jobs."""
    goals = dict(map(goal, options.names))
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(lambda name: [body(options, name, copy) for copy in range(options.copies)], goals))
        tasks = [(name, way, copy) for copy in range(options.copies) for name in goals for way in options.ways]
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
    yorp(options, "run", scene(options, name, way, copy), "--out", directory, "--until-myr", myr, *resume, way=way)


def table(options):
    """Movements by body and way."""
    print("| body | way | Myr | hand-offs | movements | a Myr | spheres: median, mean | all | inner half | outer tenth | rate of the spin changes by, % | CPU s a check | a movement |")
    print("|" + " --- |" * 13)
    for path in sorted(options.out.glob("*-0.csv")):
        name = path.stem[:-2]
        for way in options.ways:
            for copy, (_, found) in enumerate(runs(options, name, way)):
                print(row(name, way.replace("-", " of ", 1) + (f", perturbed {copy}" if copy else ""), found))


def runs(options, name, way):
    """The runs of a body in one way that have begun to evolve, and what they show, by copy."""
    directories = [options.out / f"{name}-{way}-{copy}" for copy in range(options.copies)]
    found = [(d, yorp(options, "classify", d, way=way)) for d in directories if (d / "run.sqlite").exists()]
    return [(d, f) for d, f in found if f["t_myr"] > 0]


def legs(directory):
    """Result and moved spheres of every hand-off of a run."""
    with contextlib.closing(sqlite3.connect(f"file:{directory}/run.sqlite?mode=ro", uri=True)) as database:
        return database.execute("SELECT result, moved FROM leg ORDER BY leg").fetchall()


def last_state(directory, path):
    """Writes the spheres of a run as they are now, in the columns of a built body."""
    with contextlib.closing(sqlite3.connect(f"file:{directory}/run.sqlite?mode=ro", uri=True)) as database:
        ((spheres,),) = database.execute("SELECT spheres FROM state")
    values = struct.unpack(f"<{len(spheres) // 8}d", spheres)
    columns = "x_m y_m z_m vx_m_s vy_m_s vz_m_s wx_rad_s wy_rad_s wz_rad_s mass_kg radius_m".split()
    count = len(values) // len(columns)
    rows = zip(*(values[k * count : (k + 1) * count] for k in range(len(columns))))
    path.write_text(",".join(columns) + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows))


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


def end_spin(found):
    """Spin rate at the end, rev/day."""
    return found["walk"]["intervals"][-1]["spin_rev_day"][1] if found["walk"]["intervals"] else None


MEASURES = {  # what is compared of a run: its movements' sizes, its hand-offs, what `yorp classify` finds
    "movements a hand-off": lambda sizes, hand_offs, found: len(sizes) / hand_offs,
    "movements a Myr": lambda sizes, hand_offs, found: len(sizes) / found["t_myr"],
    "spheres moved, a hand-off": lambda sizes, hand_offs, found: sum(sizes) / hand_offs,
    "log10 of the spheres in a movement": lambda sizes, hand_offs, found: statistics.mean(map(math.log10, sizes)),
    "share of single spheres": lambda sizes, hand_offs, found: sizes.count(1) / len(sizes),
    "spin in the end, rev/day": lambda sizes, hand_offs, found: end_spin(found),
    "inner half": lambda sizes, hand_offs, found: depth(found, "inner_half"),
    "outer tenth": lambda sizes, hand_offs, found: depth(found, "outer_tenth"),
}


def compare(options):
    """Means over bodies of what each way shows, and how many standard errors it is from the one it is held against.

    The error is from the scatter among the copies of one body in one way, pooled over bodies and ways. A movement so large that
    its leg is repeated counts, too: it is what the question found.
    """
    names = [path.stem[:-2] for path in sorted(options.out.glob("*-0.csv"))]
    measured = {(name, way): [measures(*run) for run in runs(options, name, way)] for name in names for way in {options.against, *options.ways}}
    print(f"| | {' | '.join(options.ways)} |")
    print("|" + " --- |" * (len(options.ways) + 1))
    for label in MEASURES:
        cells = {key: [m[label] for m in rows if m[label] is not None] for key, rows in measured.items()}
        print(f"| {label} | {' | '.join(compared(cells, names, way, options.against) for way in options.ways)} |")


def depth(found, share):
    """A share of the moved spheres, of runs in which enough of them moved to have one."""
    return found["movements"][share] if found["movements"]["spheres_moved"] >= FEWEST_SPHERES else None


def measures(directory, found):
    """What is compared of one run; None where it has no movements to speak of."""
    rows = legs(directory)
    sizes = [moved for result, moved in rows if result in ("movement", "backtracked")]
    return {
        label: measure(sizes, len(rows), found) if sizes or label.endswith(("hand-off", "Myr", "rev/day")) else None
        for label, measure in MEASURES.items()
    }


def compared(cells, names, way, against):
    """The mean of a way and its distance from another, over the bodies that both have."""
    scatter = [x - statistics.mean(xs) for xs in cells.values() if len(xs) > 1 for x in xs]
    freedom = sum(len(xs) - 1 for xs in cells.values() if len(xs) > 1)
    names = [name for name in names if cells[name, way] and cells[name, against]]
    if not names or not any(scatter):
        return "-"
    mean = statistics.mean(statistics.mean(cells[name, way]) for name in names)
    if way == against:
        return f"{mean:.3g}"
    full = statistics.mean(statistics.mean(cells[name, against]) for name in names)
    variance = sum(x * x for x in scatter) / freedom
    error = math.sqrt(variance * sum(1 / len(cells[n, w]) for n in names for w in (way, against))) / len(names)
    return f"{mean:.3g} ({(mean - full) / error:+.1f})"


def creep(options):
    """Spheres that move in each of successive stretches of five rotations without sunlight, the spin left alone."""
    print(f"| body | moved in each of {STRETCHES} times five rotations |")
    print("| --- | --- |")
    for name in options.names:
        here, moved = options.out / f"{name}-alone.csv", []
        if (options.out / name / "run.sqlite").exists():
            last_state(options.out / name, here)
        else:
            here = body(options, name, 0)
        for stretch in range(STRETCHES):
            there = options.out / f"{name}-alone-{stretch}.csv"
            moved.append(yorp(options, "relax", here, "--rotations", 5, "--out", there)["moved_spheres"])
            here = there
        print(f"| {name} | {', '.join(map(str, moved))} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=["run", "table", "compare", "creep"])
    parser.add_argument("names", nargs="*", help="scenes: NAME, or NAME=MYR; to creep also runs: NAME-WAY-COPY")
    parser.add_argument("--ways", nargs="*", choices=WAYS, default=list(WAYS), help="ways to run them")
    parser.add_argument("--against", choices=WAYS, default="full", help="the way that the others are compared with")
    parser.add_argument("--before", type=pathlib.Path, help="an older build, for the way `before`")
    parser.add_argument("--copies", type=int, default=3, help="runs of each kind: the body, and others perturbed")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "handoff_question")
    parser.add_argument("--scenes", type=pathlib.Path, default=ROOT / "scenarios" / "cotto_figueroa_2015")
    parser.add_argument("--yorp", type=pathlib.Path, default=ROOT / "target" / "release" / "yorp")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    {"run": run, "table": table, "compare": compare, "creep": creep}[options.verb](options)


if __name__ == "__main__":
    main()
