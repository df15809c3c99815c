"""Axes of carved bodies asked for and found after settling: docs/results/settled_axes.md.

    python3 studies/settled_axes.py YORP SHAPES [--jobs N]

YORP is the program, SHAPES a folder with the meshes named below (metres). Each body is carved from about a thousand
spheres in two packings and settles with two contact laws; reshaping is allowed, so that all of them have a result.
"""

import argparse
import concurrent.futures
import json
import pathlib
import re
import subprocess
import tempfile

# Mesh, bulk density (kg/m3), rotation period (h), equal-volume radius (m).
BODIES = [
    ("bennu_3200", 1190, 4.296, 245.0),
    ("ryugu_3200", 1190, 7.633, 448.3),
    ("eros_3200", 2670, 5.270, 8426.6),
    ("itokawa_3200", 1900, 12.13, 161.9),
    ("kw4_alpha_3200", 1970, 2.7645, 658.4),
]
PACKINGS = {"hcp": 0.74, "random": 0.62}
CONTACTS = {"hard": {"hard_sphere": {}}, "soft": {"soft_sphere": {"preset": "gravel"}}}
SPHERES = 1000


def settle(program: str, shapes: pathlib.Path, body: tuple, packing: str, contact: str) -> dict:
    """Builds one body and reads what was asked for and found from what the program tells."""
    name, density, period, radius = body
    fraction = PACKINGS[packing]
    spheres = {"radius_m": round(radius * (fraction / SPHERES) ** (1 / 3), 3), "grain_density_kg_m3": round(density / fraction)}
    mesh = str(shapes / f"{name}.obj")
    scene = {
        "seed": 1,
        "body": {"carved_mesh": {"path": mesh, "packing": {packing: spheres}}},
        "spin": {"period_h": period},
        "contact": CONTACTS[contact],
        "settling": {"allow_reshaping": True},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.json"
        path.write_text(json.dumps(scene))
        out = {}
        for key, more in (("made", ["--unsettled"]), ("settled", [])):
            command = [program, "build", str(path), "--out", f"{folder}/{key}.csv", "--json", "--threads", "1", *more]
            done = subprocess.run(command, capture_output=True, text=True)
            out[key] = json.loads(done.stdout) if done.returncode == 0 else None
            out["message"] = re.sub(r"\s+", " ", done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "")
    return out


def row(body: tuple, packing: str, contact: str, result: dict) -> str:
    """One line of the table."""
    name, _, period, _ = body
    made, settled = result["made"], result["settled"]
    head = f"| {name.removesuffix('_3200')} | {packing} | {contact} |"
    if made is None or settled is None:
        return f"{head} {result['message']} |" + " |" * 6
    axes = [b["b1_axes_m"] for b in (made, settled)]
    (b0, c0), (b1, c1) = ((a[1] / a[0], a[2] / a[0]) for a in axes)
    refused = max(abs(b1 - b0), abs(c1 - c0)) > 0.15 or abs(settled["period_h"] / period - 1) > 0.25
    density = [b["density_kg_m3"]["b1"] for b in (made, settled)]
    return (
        f"{head} {settled['spheres']} | {b0:.3f} -> {b1:.3f} | {c0:.3f} -> {c1:.3f} | {period:.3f} -> {settled['period_h']:.3f} "
        f"| {density[0]:.0f} -> {density[1]:.0f} | {settled['rotations']:.0f} | {'yes' if refused else 'no'} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("shapes", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    cases = [(b, p, c) for b in BODIES for p in PACKINGS for c in CONTACTS]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = list(pool.map(lambda case: settle(arguments.program, arguments.shapes.resolve(), *case), cases))
    print("| body | packing | contacts | spheres | b/a | c/a | period, h | density (B1), kg/m3 | rotations | refused |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for case, result in zip(cases, results):
        print(row(*case, result))


if __name__ == "__main__":
    main()
