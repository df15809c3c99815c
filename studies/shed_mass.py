"""Fates of what spun-up bodies shed: builds bodies, spins them beyond what they bear, counts what REBOUND finds.

    python3 studies/shed_mass.py target/release/yorp out/shed_mass

Each body is built at rest with its neighbours (a long period), then settled at ever shorter periods; what leaves while it
settles is followed for a year. Needs nothing but Python.
"""

import collections
import csv
import json
import pathlib
import sqlite3
import subprocess
import sys
import time

SOFT = {"soft_sphere": {"preset": "zhang_2017"}}
BODIES = {  # name: b/a, c/a, contact, periods in hours
    "prolate": (0.5, 0.5, None, [3.2, 2.8, 2.5]),
    "row 7": (0.7, 0.7, None, [3.2, 2.8, 2.5]),
    "round": (1.0, 0.95, None, [3.2, 2.8, 2.5]),
    "round, with friction": (1.0, 0.95, SOFT, [2.5, 2.3, 2.1]),
}


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def scene(folder, name, body, period_h, contact=None):
    path = folder / f"{name}.json"
    text = {
        "format": 1,
        "name": name,
        "seed": 1,
        "body": body,
        "spin": {"period_h": period_h, "obliquity_deg": 5},
        "settling": {"rotations": 5, "max_rotations": 10},
        "tiling": {"facets": 196},
        "shed": {"track": {"rebound": {}}},
    }
    if contact:
        text["contact"] = contact
    path.write_text(json.dumps(text))
    return path


def main():
    yorp, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    print("| body | period, h | shed | fell back | escaped | in orbit | merged | speed at fall, m/s | s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, (b, c, contact, periods_h) in BODIES.items():
        packed = {"packed_ellipsoid": {"spheres": 300, "radius_m": 75.0, "grain_density_kg_m3": 2960, "b_over_a": b, "c_over_a": c}}
        aggregate = out / f"{name}.csv"
        run(yorp, "build", scene(out, f"{name} build", packed, 8.0), "--out", aggregate)
        rows = list(csv.DictReader(aggregate.open()))
        still = out / f"{name} still.csv"
        keep = ["x_m", "y_m", "z_m", "mass_kg", "radius_m"]
        with still.open("w") as file:
            file.write(",".join(keep) + "\n")
            file.writelines(",".join(row[k] for k in keep) + "\n" for row in rows)
        for period_h in periods_h:
            directory = out / f"{name} {period_h}"
            path = scene(out, f"{name} {period_h}", {"file": {"path": still.name}}, period_h, contact)
            began = time.time()
            try:
                run(yorp, "run", path, "--out", directory, "--until-myr", 0, "--resume")
                end = ""
            except subprocess.CalledProcessError:
                end = " (fell apart)"
            database = sqlite3.connect(directory / "run.sqlite")
            fates = database.execute("SELECT fate, speed_m_s FROM fate").fetchall()
            lost = database.execute("SELECT count(*) FROM loss").fetchone()[0]
            count = collections.Counter(fate for fate, _ in fates)
            speeds = [speed for fate, speed in fates if fate == "reimpact"]
            fall = f"{sum(speeds) / len(speeds):.3f}" if speeds else "-"
            print(
                f"| {name} | {period_h}{end} | {lost} | {count['reimpact']} | {count['escape']} | {count['bound']} "
                f"| {count['merged']} | {fall} | {time.time() - began:.0f} |",
                flush=True,
            )


main()
