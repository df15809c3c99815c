"""What the rotation that is left over after settling changes in the first configuration of the paper's bodies.

    python3 studies/residual_rotation.py YORP OUT 04 07 10 12

YORP is the program, OUT a folder for scenes and runs. Each body is built and settled twice, with settling.residual_rotation "keep"
and "align"; the second table of docs/results/angular_momentum.md.
"""

import argparse
import contextlib
import json
import math
import pathlib
import sqlite3
import struct
import subprocess

SCENES = pathlib.Path(__file__).resolve().parents[1] / "scenarios" / "cotto_figueroa_2015"
REV_PER_DAY_PER_MYR = 3.15576e13 / (2 * math.pi / 86400)


def settled(program: str, folder: pathlib.Path, name: str, way: str) -> dict:
    """Builds and settles a body; its blocks, wobble, shape and torque at the scene's obliquity."""
    scene = json.loads((SCENES / f"{name}.json").read_text())
    scene["settling"] = scene.get("settling", {}) | {"residual_rotation": way}
    path, run = folder / f"{name}-{way}.json", folder / f"{name}-{way}"
    path.write_text(json.dumps(scene))
    subprocess.run([program, "run", str(path), "--out", str(run), "--until-myr", "0", "--resume", "--threads", "1"], check=True, capture_output=True)
    with contextlib.closing(sqlite3.connect(f"file:{run}/run.sqlite?mode=ro", uri=True)) as database:
        blocks, tilt = database.execute("SELECT count(*), max(non_axial) FROM settling").fetchone()
        (last,) = database.execute("SELECT non_axial FROM settling ORDER BY block DESC LIMIT 1").fetchone()
        moments, nodes, torque = database.execute("SELECT moments_kg_m2, obliquity, spin_torque FROM configuration WHERE configuration = 0").fetchone()
        (omega, obliquity) = database.execute("SELECT omega, obliquity FROM state").fetchone()
    numbers = lambda blob: struct.unpack(f"<{len(blob) // 8}d", blob)
    nearest = min(zip(numbers(nodes), numbers(torque)), key=lambda node: abs(node[0] - obliquity))
    rate = nearest[1] / numbers(moments)[2] * REV_PER_DAY_PER_MYR
    return {"blocks": blocks, "tilt": tilt, "last": last, "period_h": 2 * math.pi / omega / 3600, "rate": rate}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("names", nargs="+")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| body | way | blocks of settling | largest wobble | wobble in the end | period, h | spin changes by, rev/day/Myr |")
    print("|" + " --- |" * 7)
    for name in options.names:
        for way in ("keep", "align"):
            s = settled(options.program, options.out, name, way)
            print(f"| {name} | {way} | {s['blocks']} | {s['tilt']:.3f} | {s['last']:.3f} | {s['period_h']:.3f} | {s['rate']:+.2f} |", flush=True)


if __name__ == "__main__":
    main()
