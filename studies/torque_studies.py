"""How much the torques of a pile of spheres depend on the tiling and on what the surface does; tables in Markdown.

    python3 studies/torque_studies.py target/release/yorp out/torque_studies [resolution] [surface] [end_states]

Bodies are rows of scenarios/cotto_figueroa_2015, with 300 larger spheres except for the resolution; they are built and
settled once and kept in the output folder. Needs nothing but Python. One part alone runs if it is named.
"""

import json
import math
import pathlib
import subprocess
import sys

SCENES = pathlib.Path(__file__).parents[1] / "scenarios" / "cotto_figueroa_2015"
BODIES = ["07", "13", "02", "04", "05", "06", "08", "09", "12", "03"]
GAMMA = ["--thermal-inertia", 200]
SELF = ["--self-heating", "multiple"]


class Study:
    def __init__(self, yorp, out):
        self.yorp, self.out = pathlib.Path(yorp).resolve(), pathlib.Path(out)
        self.out.mkdir(parents=True, exist_ok=True)

    def json(self, *arguments):
        command = [str(self.yorp), *(str(a) for a in arguments), "--json"]
        return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout)

    def body(self, row, spheres):
        path = self.out / f"{row}-{spheres}.csv"
        if not path.exists():
            scene = json.loads((SCENES / f"{row}.json").read_text())
            packed = scene["body"]["packed_ellipsoid"]
            packed["radius_m"] *= (packed["spheres"] / spheres) ** (1 / 3)
            packed["spheres"] = spheres
            changed = self.out / f"{row}-{spheres}.json"
            changed.write_text(json.dumps(scene))
            self.json("build", changed, "--out", path)
        return path

    def mesh(self, row, facets=784, turn=0, spheres=300):
        path = self.out / f"{row}-{spheres}-{facets}-{turn}.obj"
        if not path.exists():
            self.json("tile", self.body(row, spheres), "--out", path, "--facets", facets, "--turn-deg", turn)
        return path

    def curves(self, mesh, *options):
        """Spin and obliquity torque over all obliquities."""
        table = self.json("torque", mesh, "--axes", "principal", *options)
        first = lambda rows: rows[0] if isinstance(rows[0], list) else rows
        return [first(table["spin_torque_n_m"]), first(table["obliquity_torque_n_m"])]


def change(curves, reference):
    """Largest difference over the largest value, percent, for each component."""
    peaks = [max(map(abs, row)) for row in reference]
    return [100 * max(abs(a - b) for a, b in zip(x, y)) / p for x, y, p in zip(curves, reference, peaks)]


def percent(values):
    return " / ".join(f"{v:.0f}" for v in values)


def resolution(study):
    counts, turns = [784, 1568, 3184, 6368, 9980], [1, 2, 5, 10]
    print("\nLargest change of the spin / obliquity torque over all obliquities, percent of the peak at 19 960 facets:\n")
    print("| body |", " | ".join(str(n) for n in counts), "|\n| --- |" + " --- |" * len(counts))
    for row in BODIES[:2]:
        curves = lambda n: study.curves(study.mesh(row, n, spheres=1000))
        finest = curves(19960)
        cells = [percent(change(curves(n), finest)) for n in counts]
        print(f"| {row} |", " | ".join(cells), "|", flush=True)
    print("\nThe same tiling with its pattern of vertices turned about the short axis, percent of its own peak:\n")
    print("| body, facets |", " | ".join(f"{t} deg" for t in turns), "|\n| --- |" + " --- |" * len(turns))
    for row in BODIES[:2]:
        for n in (784, 3184, 19960):
            curves = lambda turn: study.curves(study.mesh(row, n, turn, spheres=1000))
            cells = [percent(change(curves(turn), curves(0))) for turn in turns]
            print(f"| {row}, {n} |", " | ".join(cells), "|", flush=True)


def surface(study):
    kinds = {
        "no sky blockage": ["--sky-blockage", "off"],
        "self-heating, single": ["--self-heating", "single"],
        "self-heating, multiple": SELF,
        "Gamma 200": GAMMA,
        "Gamma 200, self-heating": GAMMA + SELF,
        "no shadows": ["--shadows", "off", "--sky-blockage", "off"],
    }
    print("\nLargest change of the spin / obliquity torque over all obliquities against the default surface, percent of the peak:\n")
    print("| body |", " | ".join(kinds), "|\n| --- |" + " --- |" * len(kinds))
    for row in BODIES:
        mesh = study.mesh(row)
        plain = study.curves(mesh)
        cells = [percent(change(study.curves(mesh, *options), plain)) for options in kinds.values()]
        print(f"| {row} |", " | ".join(cells), "|", flush=True)


def end_states(study):
    surfaces = {"Gamma = 0": [], "Gamma = 200": GAMMA, "Gamma = 200, self-heating": GAMMA + SELF}
    for start in (5, 60):
        print(f"\nWhere the rigid body ends (obliquity, deg; Myr of the YORP cycle), from {start} deg and 6 h:\n")
        print("| body |", " | ".join(surfaces), "|\n| --- |" + " --- |" * len(surfaces))
        for row in BODIES:
            cells = []
            for options in surfaces.values():
                where = ["--axes", "principal", "--obliquity-deg", start, "--duration-myr", 100]
                cycle = study.json("rigid", study.mesh(row), *where, *options)
                on_its_way = cycle["end"] in ("time_limit", "no_torque")
                end = cycle["end_obliquity_deg" if on_its_way else "attractor_obliquity_deg"]
                time = cycle["cycle_time_myr"]
                after = "" if time is None else f" after {time:.2f} Myr"
                cells.append(f"{end:.1f}, {cycle['end'].replace('_', ' ')}{after}")
            print(f"| {row} |", " | ".join(cells), "|", flush=True)


def main():
    study = Study(sys.argv[1], sys.argv[2])
    parts = {"resolution": resolution, "surface": surface, "end_states": end_states}
    for name in sys.argv[3:] or parts:
        parts[name](study)


main()
