"""How well the hand-off keeps angular momentum: the first table of docs/results/angular_momentum.md.

    python3 studies/angular_momentum.py YORP OUT [NAME ...]

YORP is the program, OUT a folder for scenes and runs, which are resumed where they are there already; NAME picks rows. Bodies of
every shape take legs close to the Sun, where torques are strong; the budget is read from their databases.
"""

import argparse
import contextlib
import json
import pathlib
import sqlite3
import subprocess

SHAPES = {"prolate": (0.6, 0.6), "oblate": (1.0, 0.6), "round": (1.0, 1.0)}
COARSE = {"obliquity_step_deg": 15, "azimuth_bins": 48, "declination_nodes": 9, "facet_samples": 1, "rotation_cells": 32}


def cases() -> dict:
    """Scenes by name: shape, spheres, contact, gravity, duration (Myr), semimajor axis (au)."""
    found = {}
    for shape in SHAPES:
        for spheres, myr in ((30, 0.02), (120, 0.02), (300, 0.02), (1000, 0.02)):
            found[f"{shape}-{spheres}-hard"] = scene(shape, spheres, {"hard_sphere": {}}, "direct", myr)
        found[f"{shape}-120-soft"] = scene(shape, 120, {"soft_sphere": {"preset": "gravel"}}, "direct", 0.005)
    found["prolate-2000-hard-tree"] = scene("prolate", 2000, {"hard_sphere": {}}, "tree", 0.01)
    found["prolate-10000-hard-tree"] = scene("prolate", 10_000, {"hard_sphere": {}}, "tree", 0.004)
    found["prolate-2000-soft-tree"] = scene("prolate", 2000, {"soft_sphere": {}}, "tree", 0.004)
    fast = scene("prolate", 120, {"hard_sphere": {}}, "direct", 0.05)
    fast["spin"]["period_h"] = 4.2
    for name, rebound in (("shedding", {}), ("returns", {"return_reimpacts": True})):
        found[f"prolate-120-{name}"] = json.loads(json.dumps(fast)) | {"shed": {"track": {"rebound": rebound}}}
    return found


def scene(shape: str, spheres: int, contact: dict, gravity: str, myr: float) -> dict:
    b, c = SHAPES[shape]
    radius = round(502 / spheres ** (1 / 3), 2)
    ellipsoid = {"spheres": spheres, "radius_m": radius, "grain_density_kg_m3": 2960, "b_over_a": b, "c_over_a": c}
    return {
        "seed": 1,
        "body": {"packed_ellipsoid": ellipsoid},
        "spin": {"period_h": 6, "obliquity_deg": 20},
        "contact": contact,
        "gravity": {"method": gravity},
        "settling": {"rotations": 1, "max_rotations": 3, "allow_reshaping": True},
        "tiling": {"facets": 384},
        "torque": COARSE,
        "orbit": {"semimajor_axis_au": 0.2},
        "evolution": {"duration_myr": myr, "spin_change": 0.005},
    }


def row(program: str, folder: pathlib.Path, name: str, content: dict) -> str:
    path, run = folder / f"{name}.json", folder / name
    path.write_text(json.dumps(content))
    done = subprocess.run([program, "run", str(path), "--out", str(run), "--resume", "--json", "--threads", "1"], capture_output=True, text=True)
    if done.returncode:
        return f"| {name} | exit {done.returncode}: {done.stderr.strip().splitlines()[-1]} | | | | | | |"
    result = json.loads(done.stdout)
    with contextlib.closing(sqlite3.connect(f"file:{run}/run.sqlite?mode=ro", uri=True)) as database:
        over_spin, wobble = database.execute("SELECT max(abs(angular_momentum_over_spin - 1)), max(non_axial) FROM leg").fetchone()
        (settling,) = database.execute("SELECT max(angular_momentum_drift) FROM settling").fetchone()
    books = result["angular_momentum"]
    return (
        f"| {name} | {result['legs']} | {result['movements']} | {100 * result['shed_mass_fraction']:.2f} | {settling:.0e} "
        f"| {books['largest_leg_error']:.0e} | {books['error']:.0e} | {over_spin or 0:.0e} | {wobble or 0:.3f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| body | legs | movements | shed, % | settling | worst leg | whole run | L / (C omega) - 1 | wobble |")
    print("|" + " --- |" * 9)
    for name, content in cases().items():
        if not options.names or name in options.names:
            print(row(options.program, options.out, name, content), flush=True)


if __name__ == "__main__":
    main()
