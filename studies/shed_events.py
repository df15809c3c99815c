"""Fates of the spheres that runs have shed, and what following them costs.

    python3 studies/shed_events.py target/release/yorp out/shed_events out/cotto_figueroa_2015/*

Counts what the runs have recorded; then gives each event's spheres, where they were and as fast as they were when the run took them
out, to `yorp track` with the body that was left, and times it. The run does not record which way the long axis pointed at
that moment: here it points along the run's x axis (or the first of eight directions that leaves no sphere in the body).
Needs nothing but Python.
"""

import array
import collections
import csv
import json
import math
import pathlib
import sqlite3
import subprocess
import sys

FATES = ["escape", "reimpact", "bound", "merged"]
HEADER = ["x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "mass_kg", "radius_m"]
DIRECTIONS = 8


def numbers(blob):
    """A blob of f64 as rows of three."""
    flat = array.array("d", blob)
    return [flat[k : k + 3] for k in range(0, len(flat), 3)]


def write(path, rows):
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([HEADER, *rows])


def body_rows(database, leg, omega, angle):
    """The spheres left after `leg`, turning about z at `omega`, the long axis at `angle` from x."""
    ids, positions, axes, centre = database.execute(
        "SELECT sphere_ids, positions, body_axes, centre_of_mass FROM configuration WHERE after_leg = ?", (leg,)
    ).fetchone()
    sizes = dict((s, (m, r)) for s, m, r in database.execute("SELECT sphere, mass_kg, radius_m FROM sphere"))
    axes, centre = numbers(axes), numbers(centre)[0]
    c, s = math.cos(angle), math.sin(angle)
    for sphere, place in zip(array.array("I", ids), numbers(positions)):
        x, y, z = (sum(a * (p - q) for a, p, q in zip(axis, place, centre)) for axis in axes)
        x, y = c * x - s * y, s * x + c * y
        yield [x, y, z, -omega * y, omega * x, 0.0, *sizes[sphere]]


def follow(yorp, folder, database, leg, omega):
    """Fates and seconds by `yorp track`."""
    sizes = {s: (m, r) for s, m, r in database.execute("SELECT sphere, mass_kg, radius_m FROM sphere")}
    shed = database.execute("SELECT sphere, position, velocity FROM loss WHERE leg = ? ORDER BY sphere", (leg,)).fetchall()
    write(folder / "shed.csv", [[*numbers(p)[0], *numbers(v)[0], *sizes[s]] for s, p, v in shed])
    for k in range(DIRECTIONS):
        write(folder / "body.csv", body_rows(database, leg, omega, k * math.tau / DIRECTIONS))
        command = [yorp, "track", folder / "body.csv", "--shed", folder / "shed.csv", "--threads", "1", "--json"]
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode == 0:
            found = json.loads(done.stdout)
            return collections.Counter(f["fate"] for f in found["fates"]), found["seconds"]
    sys.exit(f"yorp track failed:\n{done.stderr.strip()}")


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    yorp, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    print(f"| run | Myr | spin, rev/day | shed | {' | '.join(FATES)} | followed again: {' | '.join(FATES)} | s |")
    print("|" + " --- |" * 13)
    total = [0] * 10
    for run in map(pathlib.Path, sys.argv[3:]):
        if not (run / "run.sqlite").exists():
            continue
        database = sqlite3.connect(run / "run.sqlite", timeout=60)
        events = database.execute("SELECT leg, t_s, omega, count(*) FROM loss WHERE leg >= 0 GROUP BY leg ORDER BY leg").fetchall()
        for leg, t_s, omega, count in events:
            known = collections.Counter(f for (f,) in database.execute("SELECT fate FROM fate WHERE leg = ?", (leg,)))
            again, seconds = follow(yorp, folder, database, leg, omega)
            values = [count, *(known[f] for f in FATES), *(again[f] for f in FATES), seconds]
            total = [a + b for a, b in zip(total, values)]
            row(run.name, f"{t_s / 3.15576e13:.3f}", f"{omega * 86400 / math.tau:.2f}", values)
    row("all", "", "", total)


def row(name, t, spin, values):
    print("| " + " | ".join([name, t, spin, *map(str, values[:-1]), f"{values[-1]:.2f}"]) + " |", flush=True)


main()
